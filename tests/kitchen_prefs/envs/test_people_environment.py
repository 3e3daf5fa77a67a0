"""The environment of the second tier: what it shows, and what the expert's actions come to."""

from collections import Counter
from dataclasses import replace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import kitchen_prefs  # noqa: F401  (registers the environment)
from kitchen_prefs import instances
from kitchen_prefs.envs.people_demonstrations import demonstrate_people
from kitchen_prefs.envs.people_simulator import PeopleSimulator, ends
from kitchen_prefs.metrics.people_episode import PEOPLE_METRICS, care, turn, where
from kitchen_prefs.metrics.people_intervals import summarise_people
from kitchen_prefs.people.attributes import RGB
from kitchen_prefs.people.sessions import make_people_session, people_table
from kitchen_prefs.people.splits import PEOPLE_SPLITS
from kitchen_prefs.simulation.kitchen import DOOR, FIRST_DISH, SINK, Kitchen

NO = (0.0,) * 7  # no metric reads the action
ID = "kitchen_prefs/DishwasherPeople-v0"


def made(split, **options):
    return gymnasium.make(ID, split=split, **options).unwrapped


def rolled_out(environment, index, act):
    """The episode of a session, its total reward and its last info."""
    observation, info = environment.reset(options={"session": index})
    total, over = 0.0, False
    while not over:
        observation, reward, terminated, truncated, info = environment.step(act(environment))
        total += reward
        over = terminated or truncated
        assert environment.observation_space.contains(observation)
    return environment.episode(), total, info


def by_expert(environment):
    return environment.simulator.expert_action()


def at_random(environment):
    rows = environment.simulator.observation.rows
    choices = np.flatnonzero(instances.choosable(rows))
    return rows[environment.np_random.choice(choices), instances.POSE]


def test_it_is_a_gymnasium_environment():
    check_env(made("people_partial"), skip_render_check=True)


@pytest.mark.parametrize("split", PEOPLE_SPLITS)
def test_the_experts_actions_are_perfect(split):
    environment = made(split)
    for index in (0, 1):
        episode, total, info = rolled_out(environment, index, by_expert)
        assert info["is_success"]
        assert where(episode) == 1
        assert care(episode) == 0
        assert episode.turns[0] == episode.turns[1]
        assert episode.styled[0] == episode.styled[1] > 0
        assert len(episode.decisions) == episode.expert_decisions
        assert total >= episode.dishes


def test_random_actions_are_not():
    environment = made("people_partial")
    environment.reset(seed=1)
    episodes = [rolled_out(environment, index, at_random)[0] for index in range(4)]
    assert summarise_people(episodes)["H"].mean < 0.5
    for episode in episodes:
        for name, metric in PEOPLE_METRICS.items():
            value = metric(episode)
            assert value is None or value >= 0, name
            assert name in ("Care", "Refused") or value is None or value <= 1, name


def test_rows_say_what_a_dish_is_and_those_of_places_what_is_in_hand():
    environment = made("people_partial")
    environment.reset(options={"session": 3})
    dishes = environment.session.dishes
    simulator = environment.simulator
    for _ in range(20):
        rows, ids = simulator.observation.rows, simulator.observation.ids
        held = simulator.kitchen.held
        for row, instance in zip(rows, ids, strict=True):
            dish = held if instance >= 999 else instance - 3
            if instance < 3:
                assert not row[instances.COLUMNS :].any()
                continue
            assert row[instances.RGB] == pytest.approx(RGB[dishes.colour[dish]])
            assert row[instances.MATERIAL].argmax() == dishes.material[dish]
            assert row[instances.SOIL] == dishes.greasy[dish]
            assert row[instances.EXTENTS] == pytest.approx(dishes.extents[dish], rel=1e-5)
        environment.step(by_expert(environment))


def test_a_dish_ends_where_the_row_of_its_place_said():
    environment = made("people_partial")
    environment.reset(options={"session": 3})
    kitchen, over = environment.simulator.kitchen, False
    while not over:
        held, action = kitchen.held, by_expert(environment)
        *_, over, _, _ = environment.step(action)
        if held is not None and kitchen.placement[held] >= 0:
            np.testing.assert_array_equal(kitchen.pose[held], action)


def test_a_prompt_marks_one_row_of_each_decision():
    environment = made("people_inconsistent")
    observation, _ = environment.reset(options={"session": 2})
    assert observation["prompt"].shape == (3 * instances.PEOPLE_PROMPT_CAPACITY, 22)
    prompts = np.split(observation["prompt"], 3)
    for prompt, shown in zip(prompts, environment.session.prompts, strict=True):
        chosen = prompt[prompt[:, instances.DESCRIBED_COLUMNS] > 0]
        assert len(chosen) == len(shown.trajectory.decisions)
        assert chosen[:, instances.DECISION].tolist() == list(range(len(chosen)))


@pytest.mark.parametrize("index", [0, 1])
def test_a_recorded_demonstration_is_what_the_environment_shows_and_rewards(index):
    environment = made("people_evening")
    observation, _ = environment.reset(options={"session": index})
    shown = demonstrate_people(environment.session)
    for decision in range(len(shown.done)):
        assert np.array_equal(observation["instances"], shown.instances[decision])
        assert np.array_equal(observation["environment_state"], shown.environment_state[decision])
        assert np.array_equal(observation["agent_pos"], shown.state[decision])
        observation, reward, terminated, *_ = environment.step(shown.action[decision])
        assert reward == shown.reward[decision]
        assert terminated == shown.done[decision] == shown.success[decision]


def test_it_says_whose_evening_it_is():
    environment = made("people_evening")
    evenings = [
        environment.reset(options={"session": index})[0]["agent_pos"][-1] for index in range(5)
    ]
    assert set(evenings) == {0.0, 1.0}


def test_flat_sets_have_the_rows_one_after_the_other():
    flat, rows = (made("people_partial", flat=one).reset(seed=0)[0] for one in (True, False))
    assert np.array_equal(flat["instances"].reshape(rows["instances"].shape), rows["instances"])


def test_who_sinks_every_dish_has_missed_every_turn():
    session = next(
        one
        for one in (make_people_session("people_train", index) for index in range(50))
        if one.expert_turns
    )
    simulator = PeopleSimulator(session)
    kitchen = simulator.kitchen
    while not (simulator.terminated or simulator.truncated):
        waiting = kitchen.counter
        nothing_to_pick = SINK if kitchen.held is not None else DOOR
        picked = kitchen.held is None and len(waiting)
        simulator.decide(FIRST_DISH + int(waiting[0]) if picked else nothing_to_pick, NO)
    assert turn(simulator.episode()) == 0


def test_dishes_that_a_rule_on_size_tells_apart_are_not_alike():
    session = make_people_session("people_train", 0)
    sizes = Counter(session.dishes.classes("size").tolist())
    kinds = ends(session.expert.trajectory.kitchen)
    assert Counter(kind[4] for kind in kinds.elements()) == sizes


def test_the_digest_tells_of_materials_and_colours():
    session = make_people_session("people_train", 0)
    other = replace(session.dishes, colour=session.dishes.colour[::-1].copy())
    one, two = (Kitchen(dishes, people_table()).digest() for dishes in (session.dishes, other))
    assert one != two

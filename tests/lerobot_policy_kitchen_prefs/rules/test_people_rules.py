"""The rules of the second tier: by observations they do what the yardsticks do in the kitchen."""

import numpy as np
import pytest
from lerobot.envs import make_env_pre_post_processors, preprocess_observation
from lerobot.envs.utils import env_to_policy_features
from lerobot.policies import make_pre_post_processors
from lerobot.scripts.lerobot_eval import eval_policy
from lerobot.utils.constants import ACTION

from kitchen_prefs.envs.lerobot_env import KitchenPrefsEnv
from kitchen_prefs.envs.people_environment import DishwasherPeople
from kitchen_prefs.instances import POSE, choosable
from kitchen_prefs.people.attributes import draw_dishes
from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.people.splits import SLIPS
from kitchen_prefs.people.yardsticks import YARDSTICKS
from kitchen_prefs_experiments.people.ladder import load
from kitchen_prefs_experiments.people.ladder import what_is_shown as shown_in_kitchens
from lerobot_policy_kitchen_prefs.rules.configuration_rules import RulesConfig
from lerobot_policy_kitchen_prefs.rules.modeling_rules import RulesPolicy
from lerobot_policy_kitchen_prefs.rules.observed_dishes import dishes_of
from lerobot_policy_kitchen_prefs.rules.people_prompts import what_is_shown


def make_rule(rule, split):
    features = env_to_policy_features(KitchenPrefsEnv(task=split))
    action = features.pop(ACTION)
    return RulesPolicy(
        RulesConfig(rule=rule, input_features=features, output_features={ACTION: action})
    )


def rolled_out(rule, split, sessions, flat=False):
    """The episodes of a rule in some sessions, rolled out as one batch."""
    environments = [DishwasherPeople(split, flat) for _ in sessions]
    policy = make_rule(rule, split)
    pairs = zip(environments, sessions, strict=True)
    observations = [one.reset(options={"session": session})[0] for one, session in pairs]
    running = set(range(len(environments)))
    while running:
        actions = policy.select_action(batch_of(observations)).numpy()
        for i in tuple(running):
            observations[i], _, terminated, truncated, _ = environments[i].step(actions[i])
            if terminated or truncated:
                running.remove(i)
    return [environment.episode() for environment in environments]


def batch_of(observations):
    return preprocess_observation(
        {key: np.stack([one[key] for one in observations]) for key in observations[0]}
    )


@pytest.mark.parametrize(
    ("name", "split", "index"),
    [
        *((name, "people_partial", 0) for name in YARDSTICKS),
        ("bayes", "people_overflow", 5),
        ("bayes", "people_three", 2),
        ("bayes", "people_evening", 5),  # the first of two users is served
        ("bayes", "people_evening", 21),  # the second
    ],
)
def test_a_rule_loads_as_its_yardstick_does(name, split, index):
    (episode,) = rolled_out(f"people_{name}", split, [index])
    session = make_people_session(split, index)
    yardstick = load(session, YARDSTICKS[name](shown_in_kitchens(session), session.dishes))
    assert not any(episode.refused)
    assert episode.alike == yardstick.alike
    assert episode.turns == yardstick.turns
    assert len(episode.decisions) == len(yardstick.decisions)


@pytest.mark.parametrize("split", ["people_partial", "people_inconsistent"])
def test_a_prompt_is_read_as_the_kitchens_are(split):
    environment = DishwasherPeople(split)
    for session in range(2):
        observation, _ = environment.reset(options={"session": session})
        read = what_is_shown(observation["prompt"], evening=0)
        known = shown_in_kitchens(environment.session)
        assert read.slips == known.slips == (SLIPS if split == "people_inconsistent" else 0)
        assert read.first == known.first
        mine, theirs = np.argsort(read.dishes.pose[:, 0]), np.argsort(known.dishes.pose[:, 0])
        for name in ("category", "material", "colour", "greasy", "pose"):
            same = getattr(read.dishes, name)[mine] == getattr(known.dishes, name)[theirs]
            assert same.all(), name
        assert (read.zones[mine] == known.zones[theirs]).all()
        assert (read.times[mine] == known.times[theirs]).all()


def test_category_and_size_are_told_apart():
    dishes = draw_dishes(24, np.random.default_rng(0))
    rows = np.zeros((24, 21), dtype=np.float32)
    rows[:, :3] = dishes.extents
    read = dishes_of(rows, present=24)
    assert (read.category == dishes.category).all()
    assert read.scale == pytest.approx(dishes.scale, rel=1e-5)


def test_a_rule_goes_on_as_the_user_would_whatever_was_done():
    environment = DishwasherPeople("people_unseen")
    observation, _ = environment.reset(options={"session": 0})
    policy, generator = make_rule("people_bayes", "people_unseen"), np.random.default_rng(0)
    for _ in range(60):
        action = policy.select_action(batch_of([observation]))[0].numpy()
        assert (action == environment.simulator.expert_action()).all()
        if generator.random() < 0.3:
            rows = environment.simulator.observation.rows
            action = rows[generator.choice(np.flatnonzero(choosable(rows))), POSE]
        observation, _, terminated, truncated, _ = environment.step(action)
        if terminated or truncated:
            break


def test_a_rule_does_not_depend_on_the_batch_nor_on_how_sets_are_stored():
    together = rolled_out("people_tree", "people_partial", [3, 4])
    alone = [rolled_out("people_tree", "people_partial", [i], flat=True)[0] for i in (3, 4)]
    assert [one.decisions for one in together] == [one.decisions for one in alone]


@pytest.mark.lerobot
def test_lerobot_eval_rolls_a_rule_out():
    config = KitchenPrefsEnv(task="people_partial")
    policy = make_rule("people_zone", "people_partial")
    (batch,) = config.create_envs(2)["kitchen_prefs"].values()
    steps = (
        *make_env_pre_post_processors(config, policy.config),
        *make_pre_post_processors(policy.config),
    )
    results = eval_policy(batch, policy, *steps, n_episodes=2, start_seed=0)
    assert all(episode["sum_reward"] > 0 for episode in results["per_episode"])


@pytest.mark.parametrize("rule", ["symbolic", "promptless"])
def test_a_rule_of_the_first_tier_names_those_of_the_second(rule):
    with pytest.raises(ValueError, match=r"first tier; for this one there are people_promptless"):
        rolled_out(rule, "people_partial", [0])

"""The environment through gymnasium's and LeRobot's public entries."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import given, settings
from hypothesis import strategies as st
from lerobot.envs.utils import NEW_ROLLOUT_OPTION
from scipy.stats import chisquare

from kitchen_prefs import instances
from kitchen_prefs.envs.actions import nearest_row
from kitchen_prefs.envs.environment import MAX_EPISODE_STEPS, TASK, DishwasherLoading
from kitchen_prefs.envs.episode_simulator import LIMIT_FACTOR
from kitchen_prefs.envs.lerobot_env import KitchenPrefsEnv
from kitchen_prefs.metrics import edit_similarity, packing_efficiency
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.kitchen import BOTTOM_RACK, DOOR, FIRST_DISH, TOP_RACK
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs.splits import SPLITS, TEST_SPLITS

JOINTS = (DOOR, BOTTOM_RACK, TOP_RACK)


def play_expert(env, observation):
    """Let the expert act through poses; yields the row it chooses and what each step returns."""
    terminated = False
    while not terminated:
        action = env.simulator.expert_action()
        row, _ = nearest_row(instances.unpad(observation["instances"]), action)
        observation, _, terminated, _, _ = step = env.step(action)
        yield row, step


def pose_of(env, observation, instance):
    """The action that chooses an instance."""
    rows = instances.unpad(observation["instances"])
    poses = rows[instances.choosable(rows), instances.POSE]
    return next(pose for pose in poses if env.simulator.choose(pose)[0] == instance)


def test_gymnasium_accepts_it():
    check_env(
        gymnasium.make("kitchen_prefs/DishwasherLoading-v0").unwrapped, skip_render_check=True
    )


@pytest.mark.parametrize("split", [s for s in TEST_SPLITS if s != "noisy"])
def test_the_expert_is_perfect_through_poses(split):
    env = DishwasherLoading(split)
    for index in range(0, SPLITS[split].sessions, SPLITS[split].sessions // 5):
        observation, _ = env.reset(options={"session": index})
        *_, (_, last) = play_expert(env, observation)
        _, _, terminated, truncated, info = last
        assert terminated
        assert not truncated
        assert info["is_success"]
        assert packing_efficiency(env.episode()) == edit_similarity(env.episode()) == 1


def test_every_choosable_row_has_its_own_pose():
    env = DishwasherLoading("unseen_both")
    for index in (0, 5, 35):
        start, _ = env.reset(options={"session": index})
        for _, (observation, *_rest) in play_expert(env, start):
            rows = instances.unpad(observation["instances"])
            poses = rows[instances.choosable(rows), instances.POSE]
            assert len(np.unique(poses.round(4), axis=0)) == len(poses)


def test_no_position_in_the_set_gives_the_choice_away():
    env = DishwasherLoading("train")
    quantiles = []
    for index in range(0, 560, 14):
        observation, _ = env.reset(options={"session": index})
        for row, (following, *_rest) in play_expert(env, observation):
            n = len(instances.unpad(observation["instances"]))
            quantiles.append((row + 0.5) / n)
            observation = following
    counts, _ = np.histogram(quantiles, bins=8, range=(0, 1))
    assert len(quantiles) > 1000
    assert chisquare(counts).pvalue > 1e-3


def test_closed_racks_hide_their_dishes():
    env = DishwasherLoading("seen")
    start, _ = env.reset(options={"session": 3})
    most = 0
    for _, (observation, *_rest) in play_expert(env, start):
        rows, scene = instances.unpad(observation["instances"]), env.scene()
        seen = int(rows[:, instances.IS_OBJECT].sum()) - len(JOINTS)
        on_counter = sum(position[2] > layout.COUNTER_HEIGHT for _, position, _ in scene.dishes)
        most = max(most, seen - on_counter)
        if not (scene.bottom_out or scene.top_out):
            assert seen == on_counter
    racked = sum(env.episode().placed)
    assert 0 < most < racked  # those of one rack are seen while it is out, never those of both


def test_seeds_start_the_sessions_in_turn():
    env = DishwasherLoading("seen")
    for seed in (0, 69, 70, 1000):
        _, info = env.reset(seed=seed)
        assert info["session"] == seed % 70


def test_an_unseeded_reset_starts_a_fresh_session():
    env = DishwasherLoading("seen")
    env.reset(seed=4)
    fresh = []
    for _ in range(5):
        env.reset()
        fresh.append((env.session.salt, env.session.index))
    assert len(set(fresh)) == 5
    assert all(salt > 0 for salt, _ in fresh)
    env.reset(seed=4)
    env.reset()
    assert (env.session.salt, env.session.index) == fresh[0]


def test_a_salt_alone_draws_one_of_its_sessions():
    env = DishwasherLoading("seen")
    env.reset(seed=4)
    drawn = set()
    for _ in range(8):
        env.reset(options={"salt": 5})
        assert env.session.salt == 5
        drawn.add(env.session.index)
    assert len(drawn) > 4
    env.reset(seed=71, options={"salt": 5})
    assert (env.session.salt, env.session.index) == (5, 1)
    env.reset(seed=71, options={"salt": 5, "session": 33})
    assert (env.session.salt, env.session.index) == (5, 33)


def test_lerobots_own_option_is_let_through():
    env = DishwasherLoading("seen")
    env.reset(seed=9, options={NEW_ROLLOUT_OPTION: True})
    assert env.session.index == 9


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"sesion": 3}, "no option 'sesion'. Did you mean 'session'"),
        ({"index": 3}, "There are: session, salt"),
        ({"session": 3.5}, "'session' is a whole number, not 3.5"),
        ({"session": 70}, r"0\.\.69"),
        ({"salt": -1}, "natural number"),
    ],
)
def test_impossible_options_are_refused_in_one_sentence(options, words):
    with pytest.raises(ValueError, match=words):
        DishwasherLoading("seen").reset(options=options)


def test_it_ends_at_twice_the_experts_decisions():
    env = DishwasherLoading("seen")
    observation, _ = env.reset(seed=0)
    limit = LIMIT_FACTOR * len(expert_trajectory(env.session).decisions)
    rack = pose_of(env, observation, BOTTOM_RACK)
    for step in range(1, limit + 1):
        _, reward, terminated, truncated, info = env.step(rack)
        assert not terminated
        assert reward == 0
        assert "door open" in info["refusal"]
        assert truncated == (step == limit)
    assert env.episode().longest_loop == limit


@pytest.mark.slow
@pytest.mark.parametrize("split", SPLITS)
def test_no_published_session_is_longer_than_lerobots_constant(split):
    longest = max(
        len(expert_trajectory(make_session(split, index)).decisions)
        for index in range(SPLITS[split].sessions)
    )
    assert LIMIT_FACTOR * longest <= MAX_EPISODE_STEPS


def test_tracks_tell_what_they_should():
    standard = DishwasherLoading("unseen_preferences")
    observation, _ = standard.reset(seed=3)
    assert "preference" not in observation
    assert standard.task_description == TASK
    privileged = DishwasherLoading("unseen_preferences", track="privileged")
    observation, _ = privileged.reset(seed=3)
    assert observation["preference"] == [7]
    language = DishwasherLoading("unseen_preferences", track="language")
    language.reset(seed=3)
    assert language.task_description == language.session.preference.in_words


def test_noise_is_there_and_repeats():
    poses = []
    for _ in range(2):
        env = DishwasherLoading("noisy")
        observation, _ = env.reset(seed=0)
        poses.append(observation["instances"])
    np.testing.assert_array_equal(*poses)
    rows = instances.unpad(poses[0])
    dishes = rows[rows[:, 5] > 0.8]
    true = env.session.dishes.pose[: env.session.dishes.present]
    off = [np.abs(true[:, :3] - row[instances.POSITION]).sum(axis=1).min() for row in dishes]
    assert 0.001 < np.mean(off) < 0.06


def test_some_picks_fail_under_noise():
    env = DishwasherLoading("noisy")
    failed = 0
    for index in range(60):
        observation, _ = env.reset(options={"session": index})
        info = env.step(pose_of(env, observation, FIRST_DISH))[-1]
        failed += info["refusal"] == "The grasp failed."
    assert 0 < failed < 12


@settings(max_examples=100, deadline=None)
@given(st.lists(st.floats(-3, 3, width=32), min_size=7, max_size=7))
def test_any_pose_takes_the_nearest_row(action):
    env = DishwasherLoading("seen")
    observation, _ = env.reset(seed=1)
    rows, action = instances.unpad(observation["instances"]), np.array(action, dtype=np.float32)
    row, distance = nearest_row(rows, action)
    assert instances.choosable(rows)[row]
    assert distance >= 0
    taken = env.simulator.choose(action)[0]
    assert env.simulator.choose(rows[row, instances.POSE])[0] == taken
    assert env.step(action)[-1]["distance"] == pytest.approx(distance)
    assert env.episode().decisions == (taken,)


def test_a_turned_quaternion_and_its_opposite_are_one_rotation():
    observation, _ = DishwasherLoading("seen").reset(seed=1)
    rows = instances.unpad(observation["instances"])
    for row, pose in enumerate(rows[:, instances.POSE].copy()):
        pose[3:] *= -1
        assert nearest_row(rows, pose) == (row, pytest.approx(0, abs=1e-3))


@pytest.mark.parametrize(
    ("action", "words"),
    [(np.zeros(6), "7 numbers"), (np.full(7, np.nan), "NaN"), (np.zeros((1, 7)), "7 numbers")],
)
def test_an_impossible_action_is_refused_in_one_sentence(action, words):
    env = DishwasherLoading("seen")
    env.reset(seed=0)
    with pytest.raises(ValueError, match=words):
        env.step(action)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"split": "sean"}, "Did you mean 'seen'"),
        ({"track": "priviledged"}, "Did you mean 'privileged'"),
    ],
)
def test_unknown_names_suggest_the_nearest(arguments, words):
    with pytest.raises(ValueError, match=words):
        DishwasherLoading(**arguments)


@pytest.mark.parametrize("batch_size", [1, 7, 16])
def test_a_batch_of_lerobots_visits_the_sessions_in_turn(batch_size):
    env = KitchenPrefsEnv(task="seen").create_envs(batch_size)["kitchen_prefs"][0]
    visited = []
    for start in range(0, 16, batch_size):
        env.reset(seed=[1000 + start + i for i in range(batch_size)])
        visited += [session.index for session in env.get_attr("session")]
    assert visited[:16] == [(1000 + i) % 70 for i in range(16)]

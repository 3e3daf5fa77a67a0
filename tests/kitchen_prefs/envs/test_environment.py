"""The environment through gymnasium's and LeRobot's public entries."""

import gymnasium
import numpy as np
import pytest
from expert_rollout import roll_out_expert
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from stable_baselines3 import PPO
from stable_baselines3.common.env_checker import check_env as check_stable_baselines3

from kitchen_prefs import instances
from kitchen_prefs.envs.environment import TASK, DishwasherLoading
from kitchen_prefs.envs.kitchen_env import MAX_EPISODE_STEPS
from kitchen_prefs.envs.simulator import LIMIT_FACTOR
from kitchen_prefs.metrics import edit_similarity, packing_efficiency
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.kitchen import BOTTOM_RACK, DOOR, FIRST_DISH, TOP_RACK
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs.splits import SPLITS, TEST_SPLITS

JOINTS = (DOOR, BOTTOM_RACK, TOP_RACK)


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
        *_, (_, last) = roll_out_expert(env, observation)
        _, _, terminated, truncated, info = last
        assert terminated
        assert not truncated
        assert info["is_success"]
        assert packing_efficiency(env.episode()) == edit_similarity(env.episode()) == 1


def test_closed_racks_hide_their_dishes():
    env = DishwasherLoading("seen")
    start, _ = env.reset(options={"session": 3})
    most = 0
    for _, (observation, *_rest) in roll_out_expert(env, start):
        rows, scene = instances.unpad(observation["instances"]), env.scene()
        seen = int(rows[:, instances.IS_OBJECT].sum()) - len(JOINTS)
        on_counter = sum(dish.position[2] > layout.COUNTER_HEIGHT for dish in scene.dishes)
        most = max(most, seen - on_counter)
        if not (scene.bottom_out or scene.top_out):
            assert seen == on_counter
    racked = sum(env.episode().placed)
    assert 0 < most < racked  # those of one rack are seen while it is out, never those of both


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


def test_a_step_after_the_end_is_refused_and_changes_nothing():
    env = DishwasherLoading("seen")
    observation, _ = env.reset(options={"session": 3})
    first = env.simulator.expert_action()
    list(roll_out_expert(env, observation))
    episode, digest = env.episode(), env.digest()
    with pytest.raises(ResetNeeded, match=r"ended; call reset\(\)"):
        env.step(first)
    assert (env.episode(), env.digest()) == (episode, digest)
    env.reset(options={"session": 3})
    assert not env.step(first)[2]


def test_a_truncated_episode_has_ended_too():
    env = DishwasherLoading("seen")
    observation, _ = env.reset(seed=0)
    rack = pose_of(env, observation, BOTTOM_RACK)
    while not env.step(rack)[3]:
        pass
    with pytest.raises(ResetNeeded):
        env.step(rack)


@pytest.mark.parametrize(
    "query",
    [
        lambda env: env.step(np.zeros(7)),
        lambda env: env.episode(),
        lambda env: env.digest(),
        lambda env: env.session,
        lambda env: env.scene(),
        lambda env: env.simulator.expert_action(),
        lambda env: env.simulator.feasible_rows(),
    ],
)
def test_nothing_can_be_asked_before_reset(query):
    with pytest.raises(ResetNeeded, match=r"no episode yet; call reset\(\) first"):
        query(DishwasherLoading())


@pytest.mark.parametrize("split", ["seen", "noisy", "unseen_both"])
def test_every_choosable_pose_lies_within_the_bounds_of_actions(split):
    env = DishwasherLoading(split)
    assert np.isfinite((env.action_space.low, env.action_space.high)).all()
    start, _ = env.reset(seed=0)
    for _, (observation, *_rest) in roll_out_expert(env, start):
        rows = instances.unpad(observation["instances"])
        for pose in rows[instances.choosable(rows), instances.POSE]:
            assert env.action_space.contains(pose.astype(np.float32))


def test_plain_stable_baselines3_trains():
    env = gymnasium.make("kitchen_prefs/DishwasherLoading-v0")
    check_stable_baselines3(env, warn=False, skip_render_check=True)
    PPO("MultiInputPolicy", env, n_steps=8, batch_size=8, n_epochs=1, device="cpu").learn(8)


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


def test_some_picks_fail_under_noise():
    env = DishwasherLoading("noisy")
    failed = 0
    for index in range(60):
        observation, _ = env.reset(options={"session": index})
        info = env.step(pose_of(env, observation, FIRST_DISH))[-1]
        failed += info["refusal"] == "The grasp failed."
    assert 0 < failed < 12


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

"""`kitchen_prefs/Drawers-v0`, in gymnasium and in LeRobot."""

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded

pytest.importorskip("gym_hil", reason="needs the extra robot")

import kitchen_prefs_robot  # noqa: F401  registers the environment
from kitchen_prefs import instances
from kitchen_prefs.rendering.opengl import NoOpenGLError
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.prompts import prompt_for
from kitchen_prefs_robot.task.decisions import choices
from kitchen_prefs_robot.task.expert import choose

GIVEN = Conditions(perception="truth", grasps="truth")


@pytest.fixture
def env():
    env = gymnasium.make("kitchen_prefs/Drawers-v0", conditions=GIVEN, disable_env_checker=True)
    yield env.unwrapped
    env.close()


def experts_action(env):
    episode = env.episode
    row = choices(episode.state).index(choose(episode.state, episode.preference))
    return episode.rows[row, instances.POSE]


def test_the_expert_earns_a_reward_for_each_dish_and_succeeds(env):
    observation, _ = env.reset(seed=6)
    rewards, ended = [], False
    while not ended:
        assert env.observation_space.contains(observation)
        assert env.action_space.contains(experts_action(env))
        observation, reward, terminated, truncated, info = env.step(experts_action(env))
        rewards.append(reward)
        ended = terminated or truncated
    assert sum(rewards) == 4
    assert terminated
    assert info == {"is_success": True, "refusal": "", "result": "done"}
    with pytest.raises(ResetNeeded):
        env.step(np.zeros(7, np.float32))


def test_a_seed_is_a_trial_and_a_prompt_shows_another_scene(env):
    first, _ = env.reset(seed=6)
    again, _ = env.reset(seed=6)
    for name in ("instances", "prompt"):
        np.testing.assert_array_equal(first[name], again[name])
    other, _ = env.reset(seed=10)  # the same preference in another scene
    assert not np.array_equal(first["instances"], other["instances"])
    rows = instances.unpad(first["prompt"])
    assert rows[:, instances.CHOSEN].sum() == 12
    assert not (rows[:4, instances.POSITION] == first["instances"][:4, instances.POSITION]).all()


def test_nothing_can_be_asked_before_a_reset(env):
    with pytest.raises(ResetNeeded):
        env.step(np.zeros(7, np.float32))


def test_a_preference_that_there_is_not_is_named():
    with pytest.raises(ValueError, match="no preference 9"):
        gymnasium.make("kitchen_prefs/Drawers-v0", task_id=9, disable_env_checker=True)


def test_one_step_is_seen_by_the_cameras(monkeypatch):
    """The arm does not move here, and the prompt is drawn without cameras."""
    monkeypatch.setattr(
        "kitchen_prefs_robot.execution.environment.prompt_for",
        lambda scene, preference, _: prompt_for(scene, preference, GIVEN),
    )
    seen = Conditions(grasps="truth")
    env = gymnasium.make("kitchen_prefs/Drawers-v0", conditions=seen, disable_env_checker=True)
    with env:
        try:
            before, _ = env.reset(seed=6)
        except NoOpenGLError:
            pytest.skip("needs EGL")
        after, _, terminated, truncated, info = env.step(experts_action(env.unwrapped))
        assert env.observation_space.contains(after)
    assert info == {"is_success": False, "refusal": "", "result": "done"}
    assert not terminated
    assert not truncated
    for camera, picture in after["pixels"].items():
        assert picture.std() > 10, camera
        assert not np.array_equal(picture, before["pixels"][camera]), camera  # a drawer is open


@pytest.mark.slow
@pytest.mark.lerobot
def test_lerobot_makes_it_with_a_task_a_preference():
    from lerobot.envs import make_env

    from kitchen_prefs_robot.lerobot import DrawersEnv

    envs = make_env(DrawersEnv(task="perfect perception and grasps"), n_envs=1)
    assert list(envs) == ["kitchen_prefs_drawers"]
    batches = envs["kitchen_prefs_drawers"]
    assert list(batches) == [0, 1, 2, 3]
    observation, _ = batches[2].reset(seed=[0])
    assert observation["instances"].shape == (1, 936)
    assert observation["pixels"]["front"].shape == (1, 240, 320, 3)
    for batch in batches.values():
        batch.close()

"""LeRobot's batches of environments."""

import pytest

from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.lerobot_env import KitchenPrefsEnv
from kitchen_prefs.instances import DESCRIBED_FLAT_SIZE
from kitchen_prefs.people.splits import PEOPLE_SPLITS
from kitchen_prefs.splits import SPLITS


@pytest.mark.parametrize("batch_size", [1, 7, 16])
def test_a_batch_of_lerobots_visits_the_sessions_of_its_preference_in_turn(batch_size):
    env = KitchenPrefsEnv(task="seen").create_envs(batch_size)["kitchen_prefs"][2]
    visited = []
    for start in range(0, 16, batch_size):
        env.reset(seed=[1000 + start + i for i in range(batch_size)])
        visited += [session.index for session in env.get_attr("session")]
    assert visited[:16] == [20 + (1000 + i) % 10 for i in range(16)]


@pytest.mark.parametrize("split", SPLITS)
def test_the_tasks_are_the_preferences_and_hold_each_session_once(split):
    tasks = SPLITS[split].tasks
    held = sorted(session for sessions in tasks.values() for session in sessions)
    assert held == list(range(SPLITS[split].sessions))
    for label, sessions in tasks.items():
        users = {SPLITS[split].users[session] for session in sessions}
        assert users == {label} if label < 12 else min(users) >= 12
    assert KitchenPrefsEnv(task=split).create_envs(1)["kitchen_prefs"].keys() == tasks.keys()


@pytest.mark.parametrize("split", PEOPLE_SPLITS)
def test_a_split_of_the_second_tier_has_the_features_that_its_environment_shows(split):
    config = KitchenPrefsEnv(task=split)
    batches = config.create_envs(2)["kitchen_prefs"]
    assert batches.keys() == {0}
    shown = batches[0].single_observation_space
    assert {key: feature.shape for key, feature in config.features.items() if key != "action"} == {
        key: space.shape for key, space in shown.items()
    }
    assert shown["instances"].shape == (DESCRIBED_FLAT_SIZE,)


def test_a_batch_of_the_second_tier_visits_the_sessions_in_turn():
    env = KitchenPrefsEnv(task="people_partial").create_envs(3)["kitchen_prefs"][0]
    env.reset(seed=[199, 200, 201])
    assert [session.index for session in env.get_attr("session")] == [199, 0, 1]


def test_what_the_second_tier_does_not_have_is_told():
    with pytest.raises(ValueError, match=r"has no track 'language' yet; leave --env\.track out"):
        KitchenPrefsEnv(task="people_val", track="language")
    with pytest.raises(ValueError, match="Did you mean 'people_unseen'"):
        KitchenPrefsEnv(task="people_unsen")


def test_an_unseeded_reset_stays_within_the_task():
    env = DishwasherLoading("noisy", task_id=9)
    for _ in range(8):
        env.reset()
        assert env.session.label == 9
    with pytest.raises(ValueError, match=r"noisy has no task 12; it has \[0, 1"):
        DishwasherLoading("noisy", task_id=12)

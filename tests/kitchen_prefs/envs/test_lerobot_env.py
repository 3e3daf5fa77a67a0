"""LeRobot's batches of environments."""

import pytest

from kitchen_prefs.envs.lerobot_env import KitchenPrefsEnv


@pytest.mark.parametrize("batch_size", [1, 7, 16])
def test_a_batch_of_lerobots_visits_the_sessions_in_turn(batch_size):
    env = KitchenPrefsEnv(task="seen").create_envs(batch_size)["kitchen_prefs"][0]
    visited = []
    for start in range(0, 16, batch_size):
        env.reset(seed=[1000 + start + i for i in range(batch_size)])
        visited += [session.index for session in env.get_attr("session")]
    assert visited[:16] == [(1000 + i) % 70 for i in range(16)]

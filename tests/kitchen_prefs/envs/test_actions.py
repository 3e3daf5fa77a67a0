"""The row that a pose chooses."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs import instances
from kitchen_prefs.envs.actions import nearest_row
from kitchen_prefs.envs.environment import DishwasherLoading


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

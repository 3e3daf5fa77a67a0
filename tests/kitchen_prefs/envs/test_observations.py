"""The rows of an observation."""

import numpy as np
from expert_rollout import roll_out_expert
from scipy.stats import chisquare

from kitchen_prefs import instances
from kitchen_prefs.envs.environment import DishwasherLoading


def test_every_choosable_row_has_its_own_pose():
    env = DishwasherLoading("unseen_both")
    for index in (0, 5, 35):
        start, _ = env.reset(options={"session": index})
        for _, (observation, *_rest) in roll_out_expert(env, start):
            rows = instances.unpad(observation["instances"])
            poses = rows[instances.choosable(rows), instances.POSE]
            assert len(np.unique(poses.round(4), axis=0)) == len(poses)


def test_no_position_in_the_set_gives_the_choice_away():
    env = DishwasherLoading("train")
    quantiles = []
    for index in range(0, 560, 14):
        observation, _ = env.reset(options={"session": index})
        for row, (following, *_rest) in roll_out_expert(env, observation):
            n = len(instances.unpad(observation["instances"]))
            quantiles.append((row + 0.5) / n)
            observation = following
    counts, _ = np.histogram(quantiles, bins=8, range=(0, 1))
    assert len(quantiles) > 1000
    assert chisquare(counts).pvalue > 1e-3


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

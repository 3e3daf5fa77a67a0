"""Instance sets: chosen rows are found by their poses."""

import torch

from kitchen_prefs.envs.demonstrations import demonstrate
from lerobot_policy_kitchen_prefs.common.instance_sets import chosen_rows


def test_the_targets_are_the_rows_that_the_expert_chose(sessions):
    for session in sessions:
        demonstration = demonstrate(session)
        sets, actions = map(torch.from_numpy, (demonstration.instances, demonstration.action))
        assert chosen_rows(sets, actions).tolist() == demonstration.chosen_index.tolist()

"""Policies in the drawers: one that never moves on, the expert, and the committed one."""

import numpy as np
import pytest

from kitchen_prefs.instances import POSE
from kitchen_prefs_robot.task.conditions import MISREAD, evaluate
from kitchen_prefs_robot.task.metrics import METRICS, right_dishes
from kitchen_prefs_robot.task.rollouts import roll_out, roll_out_expert
from kitchen_prefs_robot.task.sessions import make_session
from kitchen_prefs_robot.task.simulator import PERFECT

SESSIONS = [make_session("test", index) for index in range(20)]


class FirstRow:
    """Points at the first row, the upper drawer, for ever."""

    def reset(self):
        self.shapes = set()

    def act(self, observations, tasks):
        self.shapes |= {(o["instances"].shape, o["prompt"].shape) for o in observations}
        return np.stack([o["instances"][0, POSE] for o in observations])


def test_a_policy_that_loops_is_stopped_at_the_limit():
    policy = FirstRow()
    episodes = roll_out(policy, SESSIONS[:3])
    assert [len(episode.decisions) for episode in episodes] == [24] * 3
    assert [right_dishes(episode) for episode in episodes] == [0] * 3
    assert policy.shapes == {((72, 13), (1664, 14))}


def test_the_expert_is_perfect_with_perfect_perception_and_not_with_misread_categories():
    for metric in METRICS.values():
        assert [metric(episode) for episode in roll_out_expert(SESSIONS, PERFECT)] == [1] * 20
    right = [right_dishes(episode) for episode in roll_out_expert(SESSIONS, MISREAD)]
    assert 0.7 < np.mean(right) < 1


@pytest.mark.lerobot
@pytest.mark.slow
def test_the_committed_checkpoint_reads_the_prompt():
    from kitchen_prefs.evaluation.policy_loading import load_policy
    from kitchen_prefs_experiments.checkpoints import find_checkpoint

    policy = load_policy(str(find_checkpoint("ttp_drawers")))
    right = {
        name: np.mean([right_dishes(episode) for episode in episodes])
        for name, episodes in evaluate(policy, SESSIONS[:16])
    }
    assert right["perfect poses"] >= 0.98
    assert right["15 mm of noise"] >= 0.95
    assert right["opposite prompt"] <= 0.05

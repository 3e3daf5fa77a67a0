"""The paper's learning-rate schedule."""

import pytest
import torch

from lerobot_policy_kitchen_prefs.ttp.scheduler import ExponentialDecaySchedulerConfig


def test_the_paper_s_schedule_decays_once_in_ten_updates():
    optimizer = torch.optim.SGD([torch.zeros(1, requires_grad=True)], lr=0.01)
    scheduler = ExponentialDecaySchedulerConfig().build(optimizer, 100)
    rates = []
    for _ in range(21):
        rates.append(optimizer.param_groups[0]["lr"])
        optimizer.step()
        scheduler.step()
    assert rates == pytest.approx([0.01] * 10 + [0.01 * 0.9995] * 10 + [0.01 * 0.9995**2])

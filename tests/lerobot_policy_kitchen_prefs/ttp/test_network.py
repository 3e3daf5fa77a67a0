"""The network's scores: what they depend on, and what not."""

import pytest
import torch
from tiny_ttp import BOTH, make_policy, observations, perturbed, scores_of

from kitchen_prefs.instances import is_real
from lerobot_policy_kitchen_prefs.ttp.configuration_ttp import ATTRIBUTES


@BOTH
@pytest.mark.parametrize("seed", range(5))
def test_padding_changes_no_score(settings, seed):
    policy = perturbed(make_policy(**settings), seed)
    for decision in range(0, 20, 2):
        batch = observations([0], decision)
        real = is_real(batch["observation.instances"])[0]
        padded = scores_of(policy, batch)[:, real]
        batch["observation.instances"] = batch["observation.instances"][:, real]
        assert torch.allclose(scores_of(policy, batch), padded, atol=1e-3)


@BOTH
@pytest.mark.parametrize("attribute", ["pose", "category", "time"])
def test_a_hidden_attribute_changes_no_score(settings, attribute):
    settings = settings | {"situation_time": True}
    policy, sees_all = make_policy(**settings, hidden=[attribute]), make_policy(**settings)
    batch = observations([0, 1], 3)
    changed = {key: rows.clone() for key, rows in batch.items()}
    for rows in changed.values():
        rows[..., ATTRIBUTES[attribute]] += 1.5 * is_real(rows)[..., None]
    real = is_real(batch["observation.instances"])
    before, after = (scores_of(policy, b)[real] for b in (batch, changed))
    assert torch.equal(before, after)
    before, after = (scores_of(sees_all, b)[real] for b in (batch, changed))
    assert not torch.allclose(before, after)

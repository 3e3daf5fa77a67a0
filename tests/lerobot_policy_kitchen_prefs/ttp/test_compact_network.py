"""The departures from the paper: geometric attention, failed choices, collisions."""

import torch
from tiny_ttp import COMPACT, make_policy, observations, perturbed, scores_of

from kitchen_prefs.instances import IS_OBJECT, IS_PLACE, POSITION
from lerobot_policy_kitchen_prefs.ttp.compact_network import GeometricAttention, GeometricTokens


def test_geometric_scores_are_squared_distances():
    torch.manual_seed(0)
    heads, dim = 2, 8
    attention = GeometricAttention(dim, heads, [(900.0, 0.0, 3.0), (0.0, 50.0, 0.0)]).double()
    with torch.no_grad():
        attention.query.weight.zero_()
        attention.query.bias.zero_()
    tokens, memory = (
        GeometricTokens(
            torch.randn(1, n, dim).double(),
            torch.ones(1, n, dtype=torch.bool),
            torch.cat([0.2 * torch.rand(1, n, 6), torch.arange(n)[None, :, None] % 2], -1).double(),
        )
        for n in (3, 5)
    )
    difference = (tokens.geometry[:, :, None] - memory.geometry[:, None]).square()
    alike = 3 * memory.geometry[:, None, :, 6] - 900 * difference[..., :3].sum(-1)
    near = -50 * difference[..., 3:6].sum(-1)
    scores = torch.stack([alike, near], dim=1)  # (1, h, N, M)
    values = attention.key_value(memory.features)[..., dim:].unflatten(-1, (heads, -1))
    expected = torch.einsum("bhnm,bmhd->bnhd", scores.softmax(-1), values).flatten(2)
    assert torch.allclose(attention(tokens, memory), attention.output(expected))


def test_a_network_can_learn_to_try_everything_before_it_repeats_itself():
    policy, batch = make_policy(**COMPACT), observations([0])
    choices = int((batch["observation.instances"][0, :, IS_OBJECT] > 0).sum())
    with torch.no_grad():
        policy.network.failures.gate.bias.fill_(100)
    actions = [tuple(policy.select_action(batch)[0].tolist()) for _ in range(choices)]
    assert len(set(actions)) == choices
    policy.reset()
    assert tuple(policy.select_action(batch)[0].tolist()) == actions[0]


def test_an_object_out_of_reach_of_every_place_changes_no_place_s_score():
    policy = perturbed(make_policy(**COMPACT), 0)
    batch = observations([0, 1], 3)  # where the first dish is put
    before = scores_of(policy, batch)
    sets = batch["observation.instances"]
    is_place = sets[..., IS_PLACE] > 0
    assert is_place.any(dim=1).all()
    counter = (sets[..., IS_OBJECT] > 0) & (sets[..., POSITION][..., 1] > 0)
    assert counter.any()
    sets[..., POSITION][counter] += 1.0
    assert torch.equal(scores_of(policy, batch)[is_place], before[is_place])

"""Score correction: blocked places and failed choices fall, and nothing else changes."""

import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs.instances import choosable
from lerobot_policy_kitchen_prefs.common.score_correction import correct_scores, lower_scores

SEEDS = st.integers(0, 10_000)


def test_without_collisions_and_failures_scores_stay(pairs):
    scores = torch.randn(pairs.sets.shape[:2])
    assert correct_scores(scores, pairs.sets, None, None) is scores
    nothing = torch.zeros_like(scores)
    assert torch.equal(correct_scores(scores, pairs.sets, nothing, nothing), scores)


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS)
def test_a_full_penalty_puts_a_row_below_all_that_may_be_chosen(pairs, seed):
    generator = torch.Generator().manual_seed(seed)
    scores = 100 * torch.randn(pairs.sets.shape[:2], generator=generator)
    failed = choosable(pairs.sets) & (torch.rand(scores.shape, generator=generator) < 0.2)
    lowered = lower_scores(scores, failed.float(), pairs.sets)
    assert torch.equal(lowered[~failed], scores[~failed])
    lowest = scores.masked_fill(~choosable(pairs.sets), torch.inf).amin(dim=1)
    assert (lowered <= lowest[:, None] - 0.99)[failed].all()


def test_a_blocked_place_falls_and_keeps_a_gradient(place_sets):
    scores = torch.randn(place_sets.shape[:2])
    log_free = torch.full_like(scores, -50.0, requires_grad=True)
    corrected = correct_scores(scores, place_sets, log_free, None)
    assert (corrected < scores - 49)[choosable(place_sets)].all()
    corrected.sum().backward()
    assert log_free.grad.all()

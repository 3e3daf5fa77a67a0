"""Scores corrected by what a network cannot weigh itself: collisions and failed choices."""

from torch import Tensor

from kitchen_prefs.instances import choosable


def correct_scores(
    scores: Tensor, sets: Tensor, log_free: Tensor | None, penalties: Tensor | None
) -> Tensor:
    """Lower the scores of blocked places and of failed choices.

    Args:
        scores: The scores of rows, (B, N).
        sets: The sets that are scored, (B, N, 13).
        log_free: The log-probability that each row is free of collisions, from `CollisionModel`,
            (B, N); None where collisions are not modelled.
        penalties: How far the score of each failed choice falls, from `FailureEmbedding`, from 0 to
            1, (B, N); None where failed choices are not modelled.

    Returns:
        The corrected scores, (B, N).
    """
    if log_free is not None:
        # The sum keeps a gradient for the shapes even where a blocked place is at the bottom.
        scores = log_free + lower_scores(scores, 1 - log_free.exp(), sets)
    if penalties is not None:
        scores = lower_scores(scores, penalties, sets)
    return scores


def lower_scores(scores: Tensor, fractions: Tensor, sets: Tensor) -> Tensor:
    """Move scores towards the lowest of their set.

    A constant penalty would not outweigh the certainty with which a wrong row was chosen, or how
    near to the corner a blocked place is; a fall to the bottom does.

    Args:
        scores: The scores, (B, N).
        fractions: How far each falls, from 0, not at all, to 1, below all that may be chosen,
            (B, N).
        sets: The sets that are scored, (B, N, 13).

    Returns:
        The scores, (B, N).
    """
    candidates = scores.detach().masked_fill(~choosable(sets), float("inf"))  # (B, N)
    lowest = candidates.amin(dim=1, keepdim=True) - 1  # (B, 1)
    return scores + fractions * (lowest - scores)

"""The loss of decisions, computed for sets of similar length together."""

from collections.abc import Callable

import torch
import torch.nn.functional as F
from torch import Tensor

from kitchen_prefs.instances import is_place_decision

from .instance_sets import accuracies, length_buckets


def decision_loss(
    sets: Tensor, targets: Tensor, score: Callable[[Tensor], Tensor]
) -> tuple[Tensor, dict[str, float]]:
    """The cross-entropy between the scores of rows and the expert's choices.

    Args:
        sets: B sets, (B, N, D).
        targets: The rows that the expert chose, (B,) int64.
        score: Scores the rows of some of the sets, whose indices it is given, (K,): (K, M).

    Returns:
        The mean loss, and the shares of picks and of places that have the highest score.
    """
    is_place = is_place_decision(sets)  # (B,)
    losses, correct = sets.new_zeros(len(sets)), torch.zeros_like(is_place)  # (B,) each
    for bucket in length_buckets(sets):
        scores = score(bucket)
        losses[bucket] = F.cross_entropy(scores, targets[bucket], reduction="none")
        correct[bucket] = scores.argmax(dim=1) == targets[bucket]
    return losses.mean(), accuracies(correct, is_place)

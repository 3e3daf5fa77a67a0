"""A memory against loops: never the same choice twice in the same set.

A decision that cannot be carried out changes nothing, and a deterministic policy that sees the same
set again would choose the same row for ever.
"""

import torch
from torch import Tensor

from kitchen_prefs.instances import DECISION

# Two sets of equal rows have sums that differ by rounding alone, in whatever order the rows stand.
TOLERANCE = 1e-9


class Repeats:
    """What was chosen in which set, since the episodes of a batch began."""

    def __init__(self) -> None:
        """Begin without a memory."""
        self._fingerprints: list[Tensor] = []  # (B,) each
        self._choices: list[Tensor] = []  # (B, 7) each

    def choose(self, sets: Tensor, poses: Tensor, scores: Tensor) -> Tensor:
        """Choose the rows with the highest scores among those not yet chosen in equal sets.

        Args:
            sets: The sets of B environments, (B, N, 13).
            poses: The poses of their first M rows, (B, M, 7).
            scores: The scores of these, -inf where a row cannot be chosen, (B, M).

        Returns:
            The poses of the chosen rows, (B, 7). Where every row was tried, all are allowed again.
        """
        fingerprints = _fingerprint(sets)
        tried = torch.zeros_like(scores, dtype=torch.bool)  # (B, M)
        for earlier, choice in zip(self._fingerprints, self._choices, strict=True):
            same_set = (fingerprints - earlier).abs() < TOLERANCE  # (B,)
            tried |= same_set[:, None] & (poses == choice[:, None]).all(dim=-1)
        untried = scores.masked_fill(tried, -torch.inf)
        exhausted = untried.isneginf().all(dim=1, keepdim=True)
        rows = scores.where(exhausted, untried).argmax(dim=1)  # (B,)
        choices = poses[torch.arange(len(rows), device=rows.device), rows]
        self._fingerprints.append(fingerprints)
        self._choices.append(choices)
        return choices


def _fingerprint(sets: Tensor) -> Tensor:
    """A number for each set that is the same in any order of rows and at any decision, (B,)."""
    rows = sets.double().index_fill(-1, torch.tensor([DECISION], device=sets.device), 0)
    columns = torch.arange(1, rows.shape[-1] + 1, device=rows.device).double()
    return (rows * columns.sqrt()).sum(dim=-1).sin().sum(dim=1)

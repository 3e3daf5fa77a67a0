"""Context history: what was seen before the current decision (paper, appendix "Markov assumption").

A closed rack hides what is in it. The objects of the k decisions before this one stand beside those
of this one, told apart by their decision's index.
"""

from collections import deque

import torch
from torch import Tensor

from kitchen_prefs.instances import IS_OBJECT

from ..common.instance_sets import keep


class History:
    """The last k sets of B episodes that are being acted in."""

    def __init__(self, length: int) -> None:
        """Begin without a past.

        Args:
            length: How many decisions k are remembered.
        """
        self._sets: deque[Tensor] = deque(maxlen=length)  # (B, N, 13) each

    def recall(self, sets: Tensor) -> Tensor:
        """Give the objects seen before, and remember what is seen now.

        Args:
            sets: What is seen now, (B, N, 13).

        Returns:
            The objects of earlier decisions, (B, H, 13); H is 0 without a past.
        """
        past = torch.stack([*self._sets], dim=1) if self._sets else sets[:, None][:, :0]
        self._sets.append(sets)
        return objects_of(past)


def objects_of(past: Tensor) -> Tensor:
    """The objects of k earlier sets, (B, k, N, 13), one below the other, (B, H, 13)."""
    rows = past.flatten(1, 2)  # (B, k N, 13)
    if rows.shape[1] == 0:
        return rows
    return keep(rows, rows[..., IS_OBJECT] > 0)[0]

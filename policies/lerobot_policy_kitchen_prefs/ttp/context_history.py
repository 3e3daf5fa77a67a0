"""Context history: earlier observations of the episode (paper, appendix "Markov assumption").

A closed rack hides what is in it. So the objects of the k decisions before the present one are
added to the present set; the decision's index distinguishes them.
"""

from collections import deque

import torch
from torch import Tensor

from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES
from kitchen_prefs.instances import IS_OBJECT, as_rows

from ..common.instance_sets import select_rows


class ContextHistory:
    """The last k sets of B episodes in a rollout."""

    def __init__(self, length: int) -> None:
        """Begin without earlier sets.

        Args:
            length: The number k of decisions to keep.
        """
        self._sets: deque[Tensor] = deque(maxlen=length)  # (B, N, 13) each

    def update(self, sets: Tensor) -> Tensor:
        """Return the objects of earlier decisions, and add the present sets.

        Args:
            sets: The present sets, (B, N, 13).

        Returns:
            The objects of earlier decisions, (B, K, 13); K is 0 where there are none.
        """
        earlier = torch.stack([*self._sets], dim=1) if self._sets else sets[:, None][:, :0]
        self._sets.append(sets)
        return objects_of(earlier)


def split_history(batch: dict[str, Tensor]) -> tuple[Tensor, Tensor]:
    """Split a batch of LeRobot's into present sets and earlier objects.

    Args:
        batch: B samples of sets, (B, N, 13), or of k + 1 sets each, (B, k + 1, N, 13); or flat.

    Returns:
        The present sets, (B, N, 13), and the objects of earlier decisions, (B, K, 13).
    """
    sets = as_rows(batch[OBS_INSTANCES])
    if sets.ndim == 3:
        return sets, sets[:, :0]
    # LeRobot repeats the first frame of an episode where there is none before it.
    exists = ~batch[f"{OBS_INSTANCES}_is_pad"][:, :-1]  # (B, k)
    return sets[:, -1], objects_of(sets[:, :-1] * exists[..., None, None])


def objects_of(sets: Tensor) -> Tensor:
    """The objects of k sets, (B, k, N, 13), concatenated, (B, K, 13)."""
    rows = sets.flatten(1, 2)  # (B, k N, 13)
    if rows.shape[1] == 0:
        return rows
    return select_rows(rows, rows[..., IS_OBJECT] > 0)[0]

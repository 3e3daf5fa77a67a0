"""Batches of instance sets: which rows were chosen, and how sets are cut and grouped."""

import torch
from torch import Tensor

from kitchen_prefs.instances import EXTENTS, IS_OBJECT, POSE, choosable, is_place_decision, is_real

# m, from corner to corner: the largest dishes have 36 cm, 41 in the second tier, the racks 75.
LARGEST_DISH = 0.5


def is_dish(rows: Tensor) -> Tensor:
    """Which rows, (..., D), are dishes, not places for them and not the door or a rack."""
    return (rows[..., IS_OBJECT] > 0) & (rows[..., EXTENTS].norm(dim=-1) < LARGEST_DISH)


def chosen_rows(sets: Tensor, actions: Tensor) -> Tensor:
    """Find the rows whose poses the actions are.

    Args:
        sets: Sets, (B, N, 13).
        actions: Exact copies of the chosen rows' poses, (B, 7).

    Returns:
        The rows, (B,) int64.

    Raises:
        ValueError: If an action is not the pose of a row that could be chosen.
    """
    matches = (sets[..., POSE] == actions[:, None]).all(dim=-1) & choosable(sets)  # (B, N)
    if not matches.any(dim=1).all():
        raise ValueError(
            "An action of the data set is not the pose of any row that could be chosen; look at it "
            "with `kitchen-prefs datasets verify`, and normalise neither sets nor actions."
        )
    return matches.int().argmax(dim=1)


def accuracies(correct: Tensor, is_place: Tensor) -> dict[str, float]:
    """How often B decisions are the expert's, for LeRobot's log.

    Args:
        correct: Whether each is, (B,) bool.
        is_place: Which of them choose places, (B,) bool.

    Returns:
        The shares among picks and among places, where there are any.
    """
    kinds = {"pick": correct[~is_place], "place": correct[is_place]}
    return {
        f"{name}_accuracy": hits.float().mean().item() for name, hits in kinds.items() if len(hits)
    }


def length_buckets(sets: Tensor) -> list[Tensor]:
    """Group sets of similar length: the place sets, and two halves of the pick sets.

    Place sets are several times as long as pick sets, and these have from 4 to some 20 rows, so
    grouping them saves most of the padding.

    Args:
        sets: Sets, (B, N, 13).

    Returns:
        The indices of each group that is not empty, (K,) int64 each.
    """
    is_place, length = is_place_decision(sets), is_real(sets).sum(dim=1)  # (B,) each
    picks = (~is_place).nonzero()[:, 0]
    picks = picks[length[picks].argsort(stable=True)]
    groups = [*picks.tensor_split(2), is_place.nonzero()[:, 0]]
    return [group for group in groups if len(group)]


def longest(sets: Tensor) -> int:
    """How many rows the longest of some sets has; their padding is at the end."""
    return int(is_real(sets).sum(dim=1).max())


def select_rows(sets: Tensor, selected: Tensor) -> tuple[Tensor, Tensor]:
    """Move the selected rows of each set to its front, in their order, and cut the rest off.

    Args:
        sets: Sets, (B, N, D).
        selected: The rows to keep, (B, N) bool.

    Returns:
        The selected rows, (B, M, D), M the largest number of them, and which are real, (B, M) bool.
    """
    index, mask = selected_indices(selected)
    return gather_rows(sets, index), mask


def selected_indices(selected: Tensor) -> tuple[Tensor, Tensor]:
    """Where the selected rows of each set are.

    Args:
        selected: The rows to keep, (B, N) bool.

    Returns:
        Their indices in their order, then others, (B, M) int64, M the largest number of selected
        rows, and which are those of selected rows, (B, M) bool.
    """
    counts = selected.sum(dim=1)  # (B,)
    longest = int(counts.max())
    index = selected.logical_not().byte().argsort(dim=1, stable=True)[:, :longest]  # (B, M)
    return index, torch.arange(longest, device=selected.device) < counts[:, None]


def gather_rows(sets: Tensor, index: Tensor) -> Tensor:
    """The rows of sets, (B, N, D), at the indices, (B, M), of each: (B, M, D)."""
    return sets.gather(1, index[..., None].expand(-1, -1, sets.shape[-1]))

"""The category of a dish, known by its extents."""

from typing import Any, Self

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.instances import EXTENTS, IS_PLACE

TOLERANCE = 1e-4  # m: below every difference between two dishes, above the rounding of float32


def nearest_category(rows: Any, extents: Any) -> Any:
    """The category whose extents differ least from each row's, in metres.

    Args:
        rows: Rows of sets or prompts, a NumPy array or a torch tensor, (..., D).
        extents: The extents of C categories in m, (C, 3).

    Returns:
        The indices of the categories, (...) int64.
    """
    difference = abs(rows[..., None, EXTENTS] - extents).sum(-1)  # (..., C)
    return difference.argmin(-1)


def nearest_noisy_category(rows: Tensor, extents: Tensor) -> tuple[Tensor, Tensor]:
    """The category whose extents differ least from each row's, in relation to their size.

    Perception's errors are relative, and of 100,000 noisy dishes this takes 4 for another category,
    `nearest_category` 40.

    Args:
        rows: Rows of sets, (..., D).
        extents: The extents of C categories in m, (C, 3).

    Returns:
        The indices of the categories, (...) int64, and the largest relative difference of the three
        extents, as the logarithm of their ratio, (...).
    """
    ratios = rows[..., None, EXTENTS] / extents  # (..., C, 3)
    difference = ratios.clamp(min=1e-6).log().abs().amax(dim=-1)  # (..., C)
    nearest, category = difference.min(dim=-1)
    return category, nearest


def category_at_any_size(rows: Any, extents: Any) -> tuple[Any, Any]:
    """The category whose extents have the same ratios as each row's, and how much larger it is.

    Dishes of the second tier are up to 15 % larger or smaller; no two categories have one shape.

    Args:
        rows: Rows of sets or prompts, a NumPy array or a torch tensor, (..., D).
        extents: The extents of C categories in m, (C, 3).

    Returns:
        The indices of the categories, (...) int64, and the scales, (...).
    """
    ratios = rows[..., None, EXTENTS] / extents  # (..., C, 3)
    uneven = abs(ratios / ratios.mean(-1)[..., None] - 1).sum(-1)  # (..., C)
    category = uneven.argmin(-1)
    return category, rows[..., EXTENTS].sum(-1) / extents.sum(-1)[category]


class Categories:
    """The categories of a data set.

    Attributes:
        extents: Their extents in m, (C, 3).
    """

    def __init__(self, extents: Tensor) -> None:
        """Take the extents of C categories, (C, 3)."""
        self.extents = extents

    @classmethod
    def from_demonstrations(cls, demonstrations: DemonstrationStore) -> Self:
        """Find the categories of demonstrations: the extents of what can be placed."""
        rows = demonstrations.rows
        extents = np.unique(rows[rows[:, IS_PLACE] > 0][:, EXTENTS], axis=0)
        return cls(torch.from_numpy(extents))

    def __len__(self) -> int:
        """The number C of categories."""
        return len(self.extents)

    def find(self, rows: Tensor) -> tuple[Tensor, Tensor]:
        """Find the category of each row.

        Args:
            rows: Rows of sets or prompts, observed without noise, (..., D).

        Returns:
            The nearest category, (...) int64, and whether it is that category, of a dish or of a
            place for one, (...) bool; the door, the racks and padding have none.
        """
        extents = self.extents.to(rows.device)
        category = nearest_category(rows, extents)
        difference = (rows[..., EXTENTS] - extents[category]).abs().amax(dim=-1)
        return category, difference < TOLERANCE

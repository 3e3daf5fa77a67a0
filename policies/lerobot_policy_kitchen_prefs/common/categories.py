"""The categories of dishes, known by their extents."""

from typing import Self

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.instances import EXTENTS, IS_PLACE

from .demonstration_store import DemonstrationStore

TOLERANCE = 1e-4  # m: below every difference between two dishes, above the rounding of float32


class Categories:
    """The categories of a data set.

    Attributes:
        extents: Their extents in m, (C, 3).
    """

    def __init__(self, extents: Tensor) -> None:
        """Take the extents of C categories, (C, 3)."""
        self.extents = extents

    @classmethod
    def of(cls, demonstrations: DemonstrationStore) -> Self:
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
            rows: Rows of sets or prompts, seen exactly, (..., D).

        Returns:
            The nearest category, (...) int64, and whether it is that category, of a dish or of a
            place for one, (...) bool; the door, the racks and padding are none.
        """
        extents = self.extents.to(rows.device)
        difference = (rows[..., None, EXTENTS] - extents).abs().amax(dim=-1)  # (..., C)
        nearest, category = difference.min(dim=-1)
        return category, nearest < TOLERANCE

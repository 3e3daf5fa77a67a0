"""The poses in the racks that demonstrations give to each category."""

from typing import Self

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.instances import CHOSEN, IS_PLACE, POSE

from .categories import Categories
from .dish_locations import in_rack, in_top_rack

RACKS = 2  # 0 the bottom one, 1 the top one


class RackPoses:
    """The poses of each category in each rack."""

    def __init__(self, poses: Tensor, counts: Tensor) -> None:
        """Take the poses.

        Args:
            poses: The distinct poses of C categories in the racks, zero-padded, (2, C, M, 7).
            counts: The number of each, (2, C) int64.
        """
        self.poses = poses
        self.counts = counts

    @classmethod
    def from_demonstrations(
        cls, demonstrations: DemonstrationStore, categories: Categories
    ) -> Self:
        """Find the places that demonstrations chose."""
        rows = demonstrations.rows
        chosen = torch.from_numpy(rows[(rows[:, IS_PLACE] > 0) & (rows[:, CHOSEN] > 0)])  # (R, 14)
        rack, racked = in_top_rack(chosen).long(), in_rack(chosen)  # (R,) each
        category, _ = categories.find(chosen)  # (R,)
        poses = [
            chosen[racked & (rack == r) & (category == c)][:, POSE].unique(dim=0)
            for r in range(RACKS)
            for c in range(len(categories))
        ]
        padded = torch.nn.utils.rnn.pad_sequence(poses, batch_first=True)  # (2 C, M, 7)
        counts = torch.tensor([len(of) for of in poses])
        return cls(padded.unflatten(0, (RACKS, -1)), counts.unflatten(0, (RACKS, -1)))

    def draw(self, rows: Tensor, category: Tensor, generator: np.random.Generator) -> Tensor:
        """Draw poses of dishes in the racks, as dishes of some category have them.

        Args:
            rows: Rows, (B, N, D).
            category: The category of each, (B, N) int64.
            generator: Source of randomness.

        Returns:
            For each row one of the known poses of the category in the row's rack; the row's own
            where none is known or the row is in no rack, (B, N, 7).
        """
        rack = in_top_rack(rows).long()  # (B, N)
        counts = self.counts.to(rows.device)[rack, category]  # (B, N)
        uniform = generator.random(counts.shape, dtype=np.float32)
        index = (torch.from_numpy(uniform).to(rows.device) * counts).long()
        poses = self.poses.to(rows.device)[rack, category, index]  # (B, N, 7)
        return poses.where((in_rack(rows) & (counts > 0))[..., None], rows[..., POSE])

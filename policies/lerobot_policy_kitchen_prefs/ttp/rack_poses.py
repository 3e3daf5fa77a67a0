"""Where dishes stand in the racks: the poses that demonstrations give each category."""

from typing import Self

import numpy as np
import torch
from torch import Tensor

from kitchen_prefs.instances import CHOSEN, IS_PLACE, POSE, POSITION
from kitchen_prefs.simulation.layout import COUNTER_Y, RACK_CLOSED

from ..common.categories import Categories
from ..common.demonstration_store import DemonstrationStore

RACKS = 2  # 0 the bottom one, 1 the top one


class RackPoses:
    """The poses of each category in each rack."""

    def __init__(self, poses: Tensor, counts: Tensor) -> None:
        """Take the poses.

        Args:
            poses: The different poses of C categories in the racks, zero-padded, (2, C, M, 7).
            counts: How many they are, (2, C) int64.
        """
        self.poses = poses
        self.counts = counts

    @classmethod
    def of(cls, demonstrations: DemonstrationStore, categories: Categories) -> Self:
        """Find the places that demonstrations chose."""
        rows = demonstrations.rows
        chosen = torch.from_numpy(rows[(rows[:, IS_PLACE] > 0) & (rows[:, CHOSEN] > 0)])  # (R, 14)
        rack, in_rack = find_racks(chosen)
        category, _ = categories.find(chosen)
        poses = [
            chosen[in_rack & (rack == r) & (category == c)][:, POSE].unique(dim=0)
            for r in range(RACKS)
            for c in range(len(categories))
        ]
        padded = torch.nn.utils.rnn.pad_sequence(poses, batch_first=True)  # (2 C, M, 7)
        counts = torch.tensor([len(of) for of in poses])
        return cls(padded.unflatten(0, (RACKS, -1)), counts.unflatten(0, (RACKS, -1)))

    def move(self, rows: Tensor, category: Tensor, generator: np.random.Generator) -> Tensor:
        """Let dishes in a rack stand there as dishes of some category do.

        Args:
            rows: Rows, (B, N, D).
            category: The category of each, (B, N) int64.
            generator: Source of randomness.

        Returns:
            The rows' poses: one at random of those that are known for the category in the row's
            rack; the row's own if none is, or if it is in no rack, (B, N, 7).
        """
        rack, in_rack = find_racks(rows)
        counts = self.counts.to(rows.device)[rack, category]  # (B, N)
        chance = generator.random(counts.shape, dtype=np.float32)
        index = (torch.from_numpy(chance).to(rows.device) * counts).long()
        poses = self.poses.to(rows.device)[rack, category, index]  # (B, N, 7)
        return poses.where((in_rack & (counts > 0))[..., None], rows[..., POSE])


def find_racks(rows: Tensor) -> tuple[Tensor, Tensor]:
    """The rack of each row, (...) int64, and whether it is in one at all, (...) bool.

    A rack is seen only while it is out, and then what it holds is in front of the counter.
    """
    _, y, z = rows[..., POSITION].unbind(dim=-1)
    return (z > RACK_CLOSED["top"][2]).long(), y < COUNTER_Y[0]

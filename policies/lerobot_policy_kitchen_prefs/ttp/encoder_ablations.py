"""What the paper compares its instance encoder with (table "Attribute Ablations" and appendix).

Attributes may be hidden, and each attribute but the marker has another encoder.
"""

from math import log

import numpy as np
import torch
from torch import Tensor, nn

from kitchen_prefs.envs.observations import DOOR_ROWS, RACK_ROWS
from kitchen_prefs.envs.observations import EXTENTS as DISH_EXTENTS
from kitchen_prefs.instances import COLUMNS, EXTENTS

from ..common.categories import nearest_category
from .configuration_ttp import ATTRIBUTES, MAX_DECISIONS


def columns_of(attributes: list[str]) -> list[int]:
    """The columns of attributes, of which `ATTRIBUTES` has the names."""
    return [column for name in attributes for column in range(COLUMNS)[ATTRIBUTES[name]]]


def hide(rows: Tensor, columns: list[int]) -> Tensor:
    """Rows, (..., 13), with zeros in some columns."""
    return rows.index_fill(-1, torch.tensor(columns, dtype=torch.long, device=rows.device), 0)


class FourierTimeEncoder(nn.Module):
    """Phi_t as sines and cosines of the decision's index, which has no largest index."""

    frequencies: Tensor  # (dim / 2,)

    def __init__(self, dim: int) -> None:
        """Make half of `dim` frequencies, of 1 to 1 / MAX_DECISIONS radians a decision."""
        super().__init__()
        frequencies = torch.exp(torch.linspace(0, -log(MAX_DECISIONS), dim // 2))
        self.register_buffer("frequencies", frequencies, persistent=False)

    def forward(self, decision: Tensor) -> Tensor:
        """Embed indices (...) as (..., dim)."""
        phases = decision[..., None] * self.frequencies  # (..., dim / 2)
        return torch.cat([phases.sin(), phases.cos()], dim=-1)


class LinearCategoryEncoder(nn.Module):
    """Phi_c as an MLP on the extents in m."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of `dim` dimensions."""
        super().__init__()
        self.layers = nn.Sequential(nn.Linear(3, dim), nn.GELU(), nn.Linear(dim, dim))

    def forward(self, extents: Tensor) -> Tensor:
        """Embed extents (..., 3) as (..., dim)."""
        return self.layers(extents)


class LabelCategoryEncoder(nn.Module):
    """Phi_c as a learned embedding of each category, which does not depend on its size."""

    extents: Tensor  # (C, 3)

    def __init__(self, dim: int) -> None:
        """Make a table of `dim` dimensions for the dishes, the door, the racks and ACT tokens."""
        super().__init__()
        others = [DOOR_ROWS[0][EXTENTS], RACK_ROWS["top"][0][EXTENTS], np.zeros(3)]
        known = torch.tensor(np.stack([*DISH_EXTENTS, *others]), dtype=torch.float32)
        self.register_buffer("extents", known, persistent=False)
        self.table = nn.Embedding(len(known), dim)

    def forward(self, extents: Tensor) -> Tensor:
        """Embed extents (..., 3) by the nearest category's entry, (..., dim)."""
        return self.table(nearest_category(extents, self.extents))


class LinearPoseEncoder(nn.Module):
    """Phi_p as one linear layer on the numbers of position and quaternion."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of `dim` dimensions."""
        super().__init__()
        self.linear = nn.Linear(7, dim)

    def forward(self, position: Tensor, quaternion: Tensor) -> Tensor:
        """Embed positions (..., 3) and quaternions (..., 4) as (..., dim)."""
        return self.linear(torch.cat([position, quaternion], dim=-1))

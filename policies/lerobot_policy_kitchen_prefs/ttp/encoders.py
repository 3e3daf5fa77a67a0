"""From a row of numbers to an embedding (paper, section 2, "Instance Encoder").

e_i = time || category || pose || marker
"""

from math import log

import numpy as np
import torch
from torch import Tensor, nn

from kitchen_prefs.envs.observations import DOOR_ROWS, RACK_ROWS
from kitchen_prefs.envs.observations import EXTENTS as DISH_EXTENTS
from kitchen_prefs.instances import DECISION, EXTENTS, IS_OBJECT, IS_PLACE, POSITION, QUATERNION

from ..common.fourier_features import (
    EXTENTS_RANGE,
    FREQUENCIES,
    POSITION_RANGE,
    QUATERNION_RANGE,
    FourierFeatures,
)
from .configuration_ttp import TTPConfig

MAX_DECISIONS = 256  # more than the longest episode has, `environment.MAX_EPISODE_STEPS`


class InstanceEncoder(nn.Module):
    """f_e: the embedding of every row of a set, those of prompt and situation alike.

    A row of zeros is the ACT token (paper, "a zero vector for all attributes").
    """

    def __init__(self, config: TTPConfig) -> None:
        """Make the four encoders, of the sizes that the configuration gives them."""
        super().__init__()
        self.time = TIME_ENCODERS[config.time_encoding](config.dim_time)
        self.extents = EXTENTS_ENCODERS[config.extents_encoding](config.dim_extents)
        self.pose = POSE_ENCODERS[config.pose_encoding](config.dim_pose)
        self.marker = MarkerEncoder(config.dim_marker)

    def forward(self, rows: Tensor) -> Tensor:
        """Embed rows (..., 13) as (..., d)."""
        return torch.cat(
            [
                self.time(rows[..., DECISION]),
                self.extents(rows[..., EXTENTS]),
                self.pose(rows[..., POSITION], rows[..., QUATERNION]),
                self.marker(rows[..., IS_OBJECT], rows[..., IS_PLACE]),
            ],
            dim=-1,
        )


class PoseEncoder(nn.Module):
    """Phi_p: Fourier features of the position and the quaternion, and one linear layer."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of size `dim`."""
        super().__init__()
        self.position = FourierFeatures(POSITION_RANGE)
        self.quaternion = FourierFeatures(QUATERNION_RANGE)
        self.linear = nn.Linear(7 * 2 * FREQUENCIES, dim)

    def forward(self, position: Tensor, quaternion: Tensor) -> Tensor:
        """Embed positions (..., 3) and quaternions (..., 4) as (..., dim)."""
        features = [self.position(position), self.quaternion(quaternion)]
        return self.linear(torch.cat(features, dim=-1))


class PoseNumbers(nn.Module):
    """The numbers of position and quaternion, and one linear layer (the paper's other encoding)."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of size `dim`."""
        super().__init__()
        self.linear = nn.Linear(7, dim)

    def forward(self, position: Tensor, quaternion: Tensor) -> Tensor:
        """Embed positions (..., 3) and quaternions (..., 4) as (..., dim)."""
        return self.linear(torch.cat([position, quaternion], dim=-1))


class ExtentsEncoder(nn.Module):
    """Phi_c: an MLP on Fourier features of the extents, the best of the paper's ablation."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of size `dim`."""
        super().__init__()
        self.layers = nn.Sequential(
            FourierFeatures(EXTENTS_RANGE),
            nn.Linear(3 * 2 * FREQUENCIES, dim),
            nn.GELU(),
            nn.Linear(dim, dim),
        )

    def forward(self, extents: Tensor) -> Tensor:
        """Embed extents (..., 3) as (..., dim)."""
        return self.layers(extents)


class ExtentsNumbers(nn.Module):
    """The same MLP on the extents in m as they are."""

    def __init__(self, dim: int) -> None:
        """Make an encoder of size `dim`."""
        super().__init__()
        self.layers = nn.Sequential(nn.Linear(3, dim), nn.GELU(), nn.Linear(dim, dim))

    def forward(self, extents: Tensor) -> Tensor:
        """Embed extents (..., 3) as (..., dim)."""
        return self.layers(extents)


class CategoryTable(nn.Module):
    """A learned embedding for each category, which says nothing of its size (the paper's other)."""

    extents: Tensor

    def __init__(self, dim: int) -> None:
        """Make a table of size `dim` for the dishes, the door, the racks and the ACT token."""
        super().__init__()
        others = [DOOR_ROWS[0][EXTENTS], RACK_ROWS["top"][0][EXTENTS], np.zeros(3)]
        known = torch.tensor(np.stack([*DISH_EXTENTS, *others]), dtype=torch.float32)
        self.register_buffer("extents", known, persistent=False)
        self.table = nn.Embedding(len(known), dim)

    def forward(self, extents: Tensor) -> Tensor:
        """Embed extents (..., 3) by the nearest category's row, (..., dim)."""
        difference = (extents[..., None, :] - self.extents).abs().sum(dim=-1)  # (..., C)
        return self.table(difference.argmin(dim=-1))


class TimeTable(nn.Module):
    """Phi_t: a learned embedding for each decision's index."""

    def __init__(self, dim: int) -> None:
        """Make a table of size `dim`."""
        super().__init__()
        self.table = nn.Embedding(MAX_DECISIONS, dim)

    def forward(self, decision: Tensor) -> Tensor:
        """Embed indices (...) as (..., dim); those beyond the table take its last entry."""
        return self.table(decision.long().clamp(0, MAX_DECISIONS - 1))


class TimeWaves(nn.Module):
    """Sines and cosines of the decision's index (the paper's other temporal encoding)."""

    frequencies: Tensor

    def __init__(self, dim: int) -> None:
        """Make waves for half of `dim` frequencies, of 1 to MAX_DECISIONS radians a period."""
        super().__init__()
        frequencies = torch.exp(torch.linspace(0, -log(MAX_DECISIONS), dim // 2))
        self.register_buffer("frequencies", frequencies, persistent=False)

    def forward(self, decision: Tensor) -> Tensor:
        """Embed indices (...) as (..., dim)."""
        phases = decision[..., None] * self.frequencies  # (..., dim / 2)
        return torch.cat([phases.sin(), phases.cos()], dim=-1)


class MarkerEncoder(nn.Module):
    """Phi_r: a learned embedding for objects, one for places, one for ACT tokens."""

    def __init__(self, dim: int) -> None:
        """Make a table of size `dim`."""
        super().__init__()
        self.table = nn.Embedding(3, dim)

    def forward(self, is_object: Tensor, is_place: Tensor) -> Tensor:
        """Embed two markers (...) as (..., dim)."""
        return self.table((is_object + 2 * is_place).long())


TIME_ENCODERS = {"table": TimeTable, "fourier": TimeWaves}
EXTENTS_ENCODERS = {"fourier": ExtentsEncoder, "linear": ExtentsNumbers, "label": CategoryTable}
POSE_ENCODERS = {"fourier": PoseEncoder, "linear": PoseNumbers}

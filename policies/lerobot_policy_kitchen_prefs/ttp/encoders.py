"""From a row of numbers to an embedding (paper, section 2, "Instance Encoder").

e_i = time || category || pose || marker
"""

from math import log, pi

import torch
from torch import Tensor, nn

from kitchen_prefs.instances import DECISION, EXTENTS, IS_OBJECT, IS_PLACE, POSITION, QUATERNION

from .configuration_ttp import TTPConfig

# Fourier features: waves whose lengths halve, `FREQUENCIES` of them for each number; sine and
# cosine make the paper's 16 features. The longest wave spans the range of the numbers once.
FREQUENCIES = 8
POSITION_RANGE = 4.0  # m, more than the counter's length; the shortest wave is 3 cm
QUATERNION_RANGE = 2.0  # -1 to 1
EXTENTS_RANGE = 1.0  # m; the shortest wave is 8 mm, so that 2.0 and 2.6 cm high plates differ
MAX_DECISIONS = 256  # more than the longest episode has, `environment.MAX_EPISODE_STEPS`


class InstanceEncoder(nn.Module):
    """f_e: the embedding of every row of a set, those of prompt and situation alike.

    A row of zeros is the ACT token (paper, "a zero vector for all attributes").
    """

    def __init__(self, config: TTPConfig) -> None:
        """Make the four encoders, of the sizes that the configuration gives them."""
        super().__init__()
        self.time = (
            TimeTable(config.dim_time)
            if config.time_encoding == "table"
            else TimeWaves(config.dim_time)
        )
        self.extents = ExtentsEncoder(config.dim_extents)
        self.pose = PoseEncoder(config.dim_pose)
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


class FourierFeatures(nn.Module):
    """Sines and cosines of each number at wave lengths that halve (NeRF's encoding)."""

    frequencies: Tensor

    def __init__(self, longest: float) -> None:
        """Make the frequencies, from the longest wave's length in the numbers' unit."""
        super().__init__()
        frequencies = 2 * pi / longest * 2.0 ** torch.arange(FREQUENCIES)
        self.register_buffer("frequencies", frequencies, persistent=False)

    def forward(self, numbers: Tensor) -> Tensor:
        """Expand (..., D) to (..., D * 2 * FREQUENCIES)."""
        phases = (numbers[..., None] * self.frequencies).flatten(-2)  # (..., D * F)
        return torch.cat([phases.sin(), phases.cos()], dim=-1)  # (..., D * 2F)


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

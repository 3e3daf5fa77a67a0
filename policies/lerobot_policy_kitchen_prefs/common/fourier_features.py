"""Fourier features of lengths in m and of quaternions (paper, section 2, "Instance Encoder")."""

from math import pi

import torch
from torch import Tensor, nn

# Wavelengths halve, FREQUENCIES of them for each number; sine and cosine make the paper's 16
# features. The longest wavelength spans the range of the numbers once.
FREQUENCIES = 8
POSITION_RANGE = 4.0  # m, more than the counter's length; the shortest wavelength is 3 cm
QUATERNION_RANGE = 2.0  # -1 to 1
EXTENTS_RANGE = 1.0  # m; the shortest wavelength is 8 mm, so that 2.0 and 2.6 cm high plates differ


class FourierFeatures(nn.Module):
    """Sines and cosines of each number at wavelengths that halve (NeRF's encoding)."""

    frequencies: Tensor  # (FREQUENCIES,)

    def __init__(self, longest: float) -> None:
        """Make the frequencies.

        Args:
            longest: The longest wavelength, in the numbers' unit.
        """
        super().__init__()
        frequencies = 2 * pi / longest * 2.0 ** torch.arange(FREQUENCIES)
        self.register_buffer("frequencies", frequencies, persistent=False)

    def forward(self, numbers: Tensor) -> Tensor:
        """Expand (..., D) to (..., D * 2 * FREQUENCIES)."""
        phases = (numbers[..., None] * self.frequencies).flatten(-2)  # (..., D * F)
        return torch.cat([phases.sin(), phases.cos()], dim=-1)  # (..., D * 2F)

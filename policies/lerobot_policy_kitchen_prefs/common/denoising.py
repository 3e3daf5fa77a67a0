"""Noisy sight undone: what is seen is known from demonstrations.

Perception errs about the size of dishes and about where they stand. Demonstrations showed every
size and every place of the racks exactly, so a dish is taken for the known one that it resembles
most, and one that is in a rack for standing in the nearest known place. Seen exactly, everything is
left as it is.
"""

import torch
from torch import Tensor, nn

from kitchen_prefs.envs.observations import EXTENT_NOISE, POSITION_NOISE
from kitchen_prefs.instances import EXTENTS, POSE

from .demonstration_store import PLACE, DemonstrationStore

CAPACITY = 1024  # places; a constant shape is what LeRobot can load. Demonstrations show 673
# What is further off than five standard deviations of perception's errors is something unknown.
UNKNOWN_EXTENTS, UNKNOWN_POSE = 5 * EXTENT_NOISE, 5 * POSITION_NOISE  # relative; m


class Denoiser(nn.Module):
    """The places that demonstrations showed, saved with the network."""

    places: Tensor

    def __init__(self) -> None:
        """Begin without a memory."""
        super().__init__()
        self.register_buffer("places", torch.zeros(CAPACITY, PLACE.stop))

    def remember(self, demonstrations: DemonstrationStore) -> None:
        """Remember all places that demonstrations showed, chosen or not.

        Args:
            demonstrations: The demonstrations.

        Raises:
            ValueError: If there are more places than can be saved.
        """
        places = torch.from_numpy(demonstrations.places)  # (K, 10)
        if len(places) > CAPACITY:
            raise ValueError(
                f"The demonstrations show {len(places)} places, and {CAPACITY} can be remembered; "
                "train without `recognise`."
            )
        self.places.zero_()[: len(places)] = places

    def forward(self, sets: Tensor) -> Tensor:
        """Take what is seen for what is known.

        Args:
            sets: Sets, (B, N, 13).

        Returns:
            The sets, with known extents and poses, (B, N, 13).
        """
        places = self.places[self.places.any(dim=1)]  # (K, 10)
        if len(places) == 0:
            return sets
        extents, category_of_place = places[:, EXTENTS].unique(dim=0, return_inverse=True)
        ratios = sets[..., None, EXTENTS] / extents  # (B, N, C, 3)
        off, category = ratios.clamp(min=1e-6).log().abs().amax(dim=-1).min(dim=-1)  # (B, N) each
        is_known = (off < UNKNOWN_EXTENTS)[..., None]  # (B, N, 1)
        distance = torch.cdist(  # a unit of the quaternion counts as a metre
            sets[..., POSE], places[:, POSE], compute_mode="donot_use_mm_for_euclid_dist"
        ).masked_fill(category_of_place != category[..., None], torch.inf)  # (B, N, K)
        off, place = distance.min(dim=-1)  # (B, N) each
        stands_there = is_known & (off < UNKNOWN_POSE)[..., None]  # (B, N, 1)
        recognised = sets.clone()
        recognised[..., EXTENTS] = extents[category].where(is_known, sets[..., EXTENTS])
        recognised[..., POSE] = places[place][..., POSE].where(stands_there, sets[..., POSE])
        return recognised

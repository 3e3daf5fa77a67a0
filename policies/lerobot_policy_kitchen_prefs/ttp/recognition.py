"""Noisy sight undone: what is seen is known from demonstrations.

Perception errs about the size of dishes and about where they stand. Demonstrations showed every
size and every place of the racks exactly, so a dish is taken for the known one that it resembles
most, and one that is in a rack for standing in the nearest known place. Seen exactly, everything is
left as it is.
"""

import torch
from torch import Tensor, nn

from kitchen_prefs.instances import EXTENTS, POSE
from kitchen_prefs.observations import EXTENT_NOISE, POSITION_NOISE

from .demonstrations import PLACE, Demonstrations

CAPACITY = 1024  # places; a constant shape is what LeRobot can load. Demonstrations show 673
# What is further off than five standard deviations of perception's errors is something unknown.
UNKNOWN_EXTENTS, UNKNOWN_POSE = 5 * EXTENT_NOISE, 5 * POSITION_NOISE  # relative; m


class Recognition(nn.Module):
    """The places that demonstrations showed, saved with the network."""

    places: Tensor

    def __init__(self) -> None:
        """Begin without a memory."""
        super().__init__()
        self.register_buffer("places", torch.zeros(CAPACITY, PLACE.stop))

    def remember(self, demonstrations: Demonstrations) -> None:
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
        kinds, kind_of_place = places[:, EXTENTS].unique(dim=0, return_inverse=True)  # (C, 3), (K,)
        relative = (sets[..., None, EXTENTS] / kinds).clamp(min=1e-6).log().abs()  # (B, N, C, 3)
        off, kind = relative.amax(dim=-1).min(dim=-1)  # (B, N) each
        is_known = (off < UNKNOWN_EXTENTS)[..., None]  # (B, N, 1)
        distance = torch.cdist(  # a metre in space counts as a unit of the quaternion
            sets[..., POSE], places[:, POSE], compute_mode="donot_use_mm_for_euclid_dist"
        )  # (B, N, K)
        of_kind = kind_of_place == kind[..., None]
        off, place = distance.masked_fill(~of_kind, torch.inf).min(dim=-1)  # (B, N) each
        stands = (off < UNKNOWN_POSE)[..., None] & is_known
        recognised = sets.clone()
        recognised[..., EXTENTS] = kinds[kind].where(is_known, sets[..., EXTENTS])
        recognised[..., POSE] = places[place][..., POSE].where(stands, sets[..., POSE])
        return recognised

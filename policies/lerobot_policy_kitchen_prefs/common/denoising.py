"""Denoises observations by snapping to known poses and extents.

Perception errs about the size of dishes and about their positions. Demonstrations showed every size
and every place of the racks exactly. So a dish takes the extents of the known category that is
nearest to it, and a dish in a rack the nearest known pose of that category. Exact observations stay
as they are.
"""

import torch
from torch import Tensor, nn

from kitchen_prefs.datasets.demonstration_store import PLACE, DemonstrationStore
from kitchen_prefs.envs.observations import EXTENT_NOISE, POSITION_NOISE
from kitchen_prefs.instances import EXTENTS, POSE

from .categories import nearest_noisy_category

CAPACITY = 1024  # places; a constant shape is what LeRobot can load. Demonstrations show 673
# What is further off than five standard deviations of perception's errors is unknown.
UNKNOWN_EXTENTS, UNKNOWN_POSE = 5 * EXTENT_NOISE, 5 * POSITION_NOISE  # relative; m


class Denoiser(nn.Module):
    """Snaps to the places that demonstrations showed, which are saved with the network."""

    places: Tensor  # (CAPACITY, 10), extents and poses, padded with zeros

    def __init__(self) -> None:
        """Begin without known places."""
        super().__init__()
        self.register_buffer("places", torch.zeros(CAPACITY, PLACE.stop))

    def fit(self, demonstrations: DemonstrationStore) -> None:
        """Store all places that demonstrations showed, chosen or not.

        Args:
            demonstrations: The demonstrations.

        Raises:
            ValueError: If there are more places than can be saved.
        """
        places = torch.from_numpy(demonstrations.places)  # (K, 10)
        if len(places) > CAPACITY:
            raise ValueError(
                f"The demonstrations show {len(places)} places, and {CAPACITY} can be stored; "
                "train without `recognise`."
            )
        self.places.zero_()[: len(places)] = places

    def forward(self, sets: Tensor) -> Tensor:
        """Denoise sets.

        Args:
            sets: Observed sets, (B, N, 13).

        Returns:
            The sets with known extents and poses, (B, N, 13).
        """
        places = self.places[self.places.any(dim=1)]  # (K, 10)
        if len(places) == 0:
            return sets
        extents, category_of_place = places[:, EXTENTS].unique(dim=0, return_inverse=True)
        category, difference = nearest_noisy_category(sets, extents)  # (B, N) each
        is_known = (difference < UNKNOWN_EXTENTS)[..., None]  # (B, N, 1)
        distance = torch.cdist(  # a unit of the quaternion counts as a metre
            sets[..., POSE], places[:, POSE], compute_mode="donot_use_mm_for_euclid_dist"
        ).masked_fill(category_of_place != category[..., None], torch.inf)  # (B, N, K)
        distance, place = distance.min(dim=-1)  # (B, N) each
        is_at_place = is_known & (distance < UNKNOWN_POSE)[..., None]  # (B, N, 1)
        denoised = sets.clone()
        denoised[..., EXTENTS] = extents[category].where(is_known, sets[..., EXTENTS])
        denoised[..., POSE] = places[place][..., POSE].where(is_at_place, sets[..., POSE])
        return denoised

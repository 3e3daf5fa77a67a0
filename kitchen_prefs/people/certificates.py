"""Whether demonstrations tell enough of a user to load certain dishes.

A certified prompt makes the exact reader of the grammar sure, so the ceiling of a split is known.
"""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs.people.attributes import DescribedDishes
from kitchen_prefs.people.posterior import Posterior
from kitchen_prefs.people.zones import IS_IN_RACK
from kitchen_prefs.preferences import RACKS

SURE = 0.97


@dataclass(frozen=True)
class Certificate:
    """How sure the reader is of what a user does with some dishes.

    Attributes:
        zones: The probability of the most probable zone, its mean over the dishes.
        ranks: The probability of the most probable order of two dishes (one, the other, or equal),
            its mean over the pairs of one rack; 1 where there is none.
    """

    zones: float
    ranks: float

    @property
    def holds(self) -> bool:
        """Whether the reader is sure of both."""
        return self.zones >= SURE and self.ranks >= SURE


def certificate(posterior: Posterior, dishes: DescribedDishes) -> Certificate:
    """Certify what is known of a user for some dishes."""
    zones = posterior.zones(dishes)  # (m, 5)
    sure_of_zones = float(zones.max(axis=1).mean())
    if sure_of_zones < SURE:
        return Certificate(sure_of_zones, 0.0)  # the order is not needed any more
    earlier = posterior.earlier(dishes)  # (m, m)
    relation = np.stack([earlier, earlier.T, 1 - earlier - earlier.T]).max(axis=0)
    pairs = ~np.eye(len(zones), dtype=bool) & _of_one_rack(zones.argmax(axis=1))
    return Certificate(sure_of_zones, float(relation[pairs].mean()) if pairs.any() else 1.0)


def _of_one_rack(zones: np.ndarray) -> np.ndarray:
    """Whether two dishes go to one rack, (m, m) bool."""
    racks = np.stack([IS_IN_RACK[rack][zones] for rack in RACKS])  # (2, m)
    return (racks[:, :, None] & racks[:, None, :]).any(axis=0)

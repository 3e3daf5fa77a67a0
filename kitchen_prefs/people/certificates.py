"""Whether demonstrations tell enough of a user to load certain dishes.

A certified prompt makes the exact reader of the grammar sure, so the ceiling of a split is known.
"""

from dataclasses import dataclass, replace

import numpy as np

from kitchen_prefs.people.attributes import DescribedDishes
from kitchen_prefs.people.expert import ends_of, roll_out_plan
from kitchen_prefs.people.posterior import Posterior
from kitchen_prefs.simulation.kitchen import Kitchen, PlacementTable

SURE = 0.97


@dataclass(frozen=True)
class Certificate:
    """How sure the reader is of what a user does with some dishes.

    Attributes:
        destinations: The probability that a dish ends where the most probable user puts it: that of
            its zone, and of an overflow with which it ends there; its mean over the dishes.
        ranks: The probability of the most probable order of two dishes (one, the other, or equal),
            its mean over all pairs.
    """

    destinations: float
    ranks: float

    @property
    def holds(self) -> bool:
        """Whether the reader is sure of both."""
        return self.destinations >= SURE and self.ranks >= SURE


def certificate(
    posterior: Posterior, dishes: DescribedDishes, table: PlacementTable
) -> Certificate:
    """Certify what is known of a user for some dishes, which can stand at a table's placements."""
    destinations = _sure_of_zones(posterior, dishes) * _sure_of_overflow(posterior, dishes, table)
    return Certificate(float(destinations.mean()), _sure_of_ranks(posterior, dishes))


def is_certified(posterior: Posterior, dishes: DescribedDishes, table: PlacementTable) -> bool:
    """Whether the certificate holds; what takes longest is computed only where the rest is sure."""
    if _sure_of_ranks(posterior, dishes) < SURE:
        return False
    zones = _sure_of_zones(posterior, dishes)  # (m,)
    if zones.mean() < SURE:
        return False
    return float((zones * _sure_of_overflow(posterior, dishes, table)).mean()) >= SURE


def _sure_of_ranks(posterior: Posterior, dishes: DescribedDishes) -> float:
    earlier = posterior.earlier(dishes)  # (m, m)
    relation = np.stack([earlier, earlier.T, 1 - earlier - earlier.T]).max(axis=0)
    return float(relation[~np.eye(len(relation), dtype=bool)].mean())


def _sure_of_zones(posterior: Posterior, dishes: DescribedDishes) -> np.ndarray:
    """The probability of the most probable zone of each dish, (m,)."""
    return posterior.zones(dishes).max(axis=1)


def _sure_of_overflow(
    posterior: Posterior, dishes: DescribedDishes, table: PlacementTable
) -> np.ndarray:
    """How probable the overflows are with which each dish ends in the same zone, (m,)."""
    guess = posterior.guess(dishes)

    def ends(overflow: str) -> np.ndarray:
        plan = replace(guess, overflow=overflow)
        return ends_of(roll_out_plan(Kitchen(dishes, table), plan).kitchen)

    most_probable = ends(guess.overflow)
    same = np.zeros(len(most_probable))
    for overflow, probability in posterior.overflows(dishes).items():
        if probability > 1 - SURE:
            same += probability * (ends(overflow) == most_probable)
    return same

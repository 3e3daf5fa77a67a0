"""Which category a cluster is of: its median colour, held against a known set (the paper's way)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

# RGB distance to the nearest known dish: a lamp that is a fifth brighter moves white by .3.
UNKNOWN_BEYOND = 0.40


@dataclass(frozen=True)
class KnownDish:
    """A dish that the robot may meet.

    Attributes:
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        colour: RGB from 0 to 1 as the cameras saw it under the usual lamp.
        extents: Its full size, (3,) m, by a ruler.
    """

    category: str
    colour: tuple[float, float, float]
    extents: tuple[float, float, float]


def nearest_by_colour(colour: np.ndarray, known: Sequence[KnownDish]) -> KnownDish | None:
    """The known dish whose colour is nearest, or None if none is near.

    Args:
        colour: The median RGB of a cluster, (3,).
        known: The set of dishes.
    """
    distances = [float(np.linalg.norm(colour - dish.colour)) for dish in known]
    nearest = int(np.argmin(distances))
    return known[nearest] if distances[nearest] <= UNKNOWN_BEYOND else None

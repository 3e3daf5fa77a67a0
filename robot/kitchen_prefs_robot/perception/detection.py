"""From one cloud to what stands where: dishes with category and pose, drawers with their opening.

cloud -> regions (counter, hand, open drawers) -> clusters -> categories -> dishes
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from kitchen_prefs_robot.perception.categories import KnownDish, nearest_by_colour
from kitchen_prefs_robot.perception.cloud import Cloud, joined
from kitchen_prefs_robot.perception.clusters import Box, box_round, find_clusters
from kitchen_prefs_robot.perception.plane import Plane
from kitchen_prefs_robot.perception.regions import Place, cut_regions, open_drawer

STANDING = 0.03  # m: what reaches down to that height stands on the table
FITS = 1.15  # times a known dish's size: fragments that are no larger together are one dish
BESIDE = 0.010  # m: a point so near to a dish is its own
TOO_LARGE = 1.4  # times a known dish's size: several dishes that touch


@dataclass(frozen=True)
class Detection:
    """A dish that the cameras see.

    Attributes:
        category: One of `kitchen_prefs.preferences.CATEGORIES`; None if its colour is not known.
        place: Where it is: on the counter, in a person's hand, or in an open drawer.
        cloud: Its points, in the base's frame.
        box: Round its points; its middle is a better position than the points' mean.
    """

    category: str | None
    place: Place
    cloud: Cloud
    box: Box

    @property
    def mean(self) -> np.ndarray:
        """The mean of its points, (3,) m: the paper's position."""
        return self.cloud.points.mean(axis=0)

    @property
    def colour(self) -> np.ndarray:
        """The median RGB of its points, (3,)."""
        return median_colour(self.cloud)


@dataclass(frozen=True)
class Touching:
    """A cluster that is larger than any dish: dishes that touch, and no colour tells them apart.

    Attributes:
        place: Where they are.
        box: Round all of them.
    """

    place: Place
    box: Box

    @property
    def sentence(self) -> str:
        """What to do about it."""
        length, width, _ = 100 * self.box.extents
        where = "on the counter" if self.place == "counter" else f"({self.place})"
        return (
            f"What stands {where} on {length:.0f} x {width:.0f} cm is larger than any dish: dishes "
            "touch, and their colours do not tell them apart; move them apart."
        )


@dataclass(frozen=True)
class Sight:
    """What one look says.

    Attributes:
        dishes: The dishes, by place, those with most points first.
        openings: How far each drawer is open, m.
        touching: What could not be told apart.
        obstacles: All points above the table and in open drawers, stands included, (N, 3) m.
    """

    dishes: tuple[Detection, ...]
    openings: dict[str, float]
    touching: tuple[Touching, ...]
    obstacles: np.ndarray

    @property
    def opened(self) -> str | None:
        """The drawer that is open; None if both are closed."""
        return open_drawer(self.openings)

    def obstacles_beside(self, dish: Detection) -> np.ndarray:
        """The points of all else, which a grasp of a dish must not touch, (N, 3) m."""
        distances = cKDTree(dish.cloud.points).query(self.obstacles)[0]
        return self.obstacles[distances > BESIDE]


def perceive(cloud: Cloud, known: Sequence[KnownDish], seed: int = 0) -> Sight:
    """Find the dishes and the drawers' openings in a cloud.

    Args:
        cloud: All that the cameras see, in the base's frame.
        known: The dishes that the robot may meet.
        seed: Of the random samples that find the table.

    Raises:
        NotSeenError: If the cameras see no table, or not the front of a drawer.
    """
    regions = cut_regions(cloud, np.random.default_rng(seed))
    largest = max(max(dish.extents) for dish in known)
    found: list[Detection] = []
    touching: list[Touching] = []
    for place, region in regions.clouds.items():
        for cluster in join_fragments(find_clusters(region, FITS * largest), known):
            dish = nearest_by_colour(median_colour(cluster), known)
            box = _box(cluster, regions.table)
            if _is_too_large(box, known):
                touching.append(Touching(place, box))
            else:
                found.append(Detection(dish.category if dish else None, place, cluster, box))
    return Sight(tuple(found), regions.openings, tuple(touching), regions.obstacles.points)


def median_colour(cloud: Cloud) -> np.ndarray:
    """The median RGB of points, (3,)."""
    return np.median(cloud.colours, axis=0)


def join_fragments(clusters: Sequence[Cloud], known: Sequence[KnownDish]) -> list[Cloud]:
    """Join clusters of one colour that fit into one dish: its sides, seen by different cameras.

    Args:
        clusters: The largest first.
        known: The dishes that the robot may meet.
    """
    whole: list[Cloud] = []
    for cluster in clusters:
        for number, other in enumerate(whole):
            if _is_one_dish(joined([other, cluster]), (other, cluster), known):
                whole[number] = joined([other, cluster])
                break
        else:
            whole.append(cluster)
    return whole


def _is_one_dish(both: Cloud, parts: tuple[Cloud, Cloud], known: Sequence[KnownDish]) -> bool:
    first, second = (nearest_by_colour(median_colour(part), known) for part in parts)
    return first is not None and first == second and _fits(box_round(both.points), first, FITS)


def _fits(box: Box, dish: KnownDish, size: float) -> bool:
    """Whether a box is no larger than a dish that is enlarged by `size`."""
    return bool((box.extents <= size * max(dish.extents)).all())


def _is_too_large(box: Box, known: Sequence[KnownDish]) -> bool:
    return not any(_fits(box, dish, TOO_LARGE) for dish in known)


def _box(cluster: Cloud, table: Plane) -> Box:
    """The box of a cluster; one that stands on the table reaches down to it."""
    stands = table.heights(cluster.points).min() < STANDING
    return box_round(cluster.points, floor=0.0 if stands else None)

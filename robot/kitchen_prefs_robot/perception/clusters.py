"""Objects as clusters of points, and their poses.

DBSCAN joins what lies close together. Two dishes that touch become one cluster, which is then
larger than any dish: it is taken apart by position and colour together.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
from sklearn.cluster import DBSCAN

from kitchen_prefs_robot.perception.cloud import Cloud

NEIGHBOURS_WITHIN = 0.018  # m: three times the side of a cube of the thinned cloud
NEIGHBOURS = 12  # a point with fewer within that distance is noise; on a surface it has thirty
FEWEST_POINTS = 40  # a cup has some 400; fewer are stray pixels of an edge
# m that a full change of a colour channel weighs when touching dishes are taken apart.
COLOUR_WEIGHT = 0.10


@dataclass(frozen=True)
class Box:
    """An upright box round points, turned about z so that its footprint is smallest.

    Attributes:
        middle: (3,) m.
        extents: Length, width and height, (3,) m, the length not less than the width.
        yaw: The turn of the length from x, radians, in [-pi / 2, pi / 2).
    """

    middle: np.ndarray
    extents: np.ndarray
    yaw: float


def box_round(points: np.ndarray, floor: float | None = None) -> Box:
    """The box round points, (N, 3) m.

    Args:
        points: At least one.
        floor: The height of what the object stands on, m, where the points do not reach down to it.
    """
    (x, y), (first, second), degrees = cv2.minAreaRect(points[:, :2].astype(np.float32))
    low, high = points[:, 2].min(), points[:, 2].max()
    low = low if floor is None else min(low, floor)
    turn = degrees if first >= second else degrees + 90.0
    yaw = np.deg2rad((turn + 90.0) % 180.0 - 90.0)
    extents = np.array([max(first, second), min(first, second), high - low])
    return Box(np.array([x, y, (low + high) / 2]), extents, float(yaw))


def find_clusters(cloud: Cloud, largest: float) -> list[Cloud]:
    """The clusters of a thinned cloud.

    Args:
        cloud: Points above the table, in the base's frame.
        largest: The length of the largest dish, m; a longer cluster is several dishes that touch.

    Returns:
        The clusters, the largest first.
    """
    clusters = []
    for cluster in _close_together(cloud, cloud.points):
        length = box_round(cluster.points).extents[0]
        clusters += [cluster] if length <= largest else _by_colour(cluster)
    return sorted(clusters, key=len, reverse=True)


def _by_colour(cloud: Cloud) -> list[Cloud]:
    """Take touching dishes apart; one colour stays one cluster."""
    places = np.concatenate([cloud.points, COLOUR_WEIGHT * cloud.colours], axis=1)  # (N, 6)
    return list(_close_together(cloud, places)) or [cloud]


def _close_together(cloud: Cloud, places: np.ndarray) -> Iterator[Cloud]:
    """The clusters of a cloud whose points lie at `places`, (N, D) m."""
    if len(cloud) == 0:
        return
    labels = DBSCAN(eps=NEIGHBOURS_WITHIN, min_samples=NEIGHBOURS).fit_predict(places)
    for label in range(labels.max() + 1):
        if (labels == label).sum() >= FEWEST_POINTS:
            yield cloud.where(labels == label)

"""What was found, tinted in a camera's picture."""

import colorsys
from collections.abc import Sequence

import numpy as np
from scipy.spatial import cKDTree

from kitchen_prefs_robot.perception.cloud import Cloud, Frame, deproject, moved
from kitchen_prefs_robot.perception.detection import Detection

WITHIN = 0.012  # m from a cluster's points, which are 6 mm apart
GOLDEN = 0.618  # of the circle of hues: neighbours in the list look different


def beside_clusters(frame: Frame, pose: np.ndarray, dishes: Sequence[Detection]) -> np.ndarray:
    """A camera's picture, and beside it the same with each cluster in a colour of its own.

    Args:
        frame: The picture with depth.
        pose: The transform from the camera's frame to the base's, (4, 4).
        dishes: What was found.

    Returns:
        (H, 2 W, 3) uint8.
    """
    grey = np.repeat(frame.colour.mean(axis=2, keepdims=True) / 2 + 96, 3, axis=2)  # (H, W, 3)
    rows, columns = np.nonzero(frame.depth > 0)
    points = moved(deproject(frame), pose).points
    for number, dish in enumerate(dishes):
        near = _is_near(points, dish.cloud)
        grey[rows[near], columns[near]] = 255 * np.array(cluster_colour(number))
    return np.concatenate([frame.colour, grey.astype(np.uint8)], axis=1)


def cluster_colour(number: int) -> tuple[float, float, float]:
    """The RGB, from 0 to 1, in which a cluster is shown."""
    return colorsys.hsv_to_rgb(GOLDEN * number % 1.0, 0.9, 0.95)


def _is_near(points: np.ndarray, cluster: Cloud) -> np.ndarray:
    distances = cKDTree(cluster.points).query(points, distance_upper_bound=WITHIN)[0]
    return np.isfinite(distances)

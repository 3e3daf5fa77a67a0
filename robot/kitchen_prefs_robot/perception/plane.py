"""The table's plane, by random sample consensus."""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs_robot.perception.not_seen import NotSeenError

TRIALS = 100  # half of the points lie on the table: a trial in eight hits it
INLIER = 0.01  # m: twice the depth's standard deviation at a metre and more


@dataclass(frozen=True)
class Plane:
    """normal . point = offset.

    Attributes:
        normal: Unit vector that points up, (3,).
        offset: m.
    """

    normal: np.ndarray
    offset: float

    def heights(self, points: np.ndarray) -> np.ndarray:
        """How far points, (N, 3), lie above the plane, (N,) m."""
        return points @ self.normal - self.offset


def find_plane(points: np.ndarray, rng: np.random.Generator) -> Plane:
    """Find the plane that most points lie on.

    Args:
        points: (N, 3) m.
        rng: Draws the three points of each trial.

    Returns:
        The best trial's plane, fitted to all its inliers by least squares.

    Raises:
        NotSeenError: If there are fewer than three points.
    """
    if len(points) < 3:
        raise NotSeenError("The cameras see no table; check that they look at it and see depth.")
    samples = points[rng.integers(len(points), size=(TRIALS, 3))]  # (T, 3, 3)
    normals = np.cross(samples[:, 1] - samples[:, 0], samples[:, 2] - samples[:, 0])  # (T, 3)
    lengths = np.linalg.norm(normals, axis=1)
    normals = normals[lengths > 0] / lengths[lengths > 0, None]
    offsets = (normals * samples[lengths > 0, 0]).sum(axis=1)  # (T,)
    inliers = np.abs(points @ normals.T - offsets) < INLIER  # (N, T)
    return _fitted(points[inliers[:, inliers.sum(axis=0).argmax()]])


def _fitted(points: np.ndarray) -> Plane:
    """The least-squares plane of points, (N, 3)."""
    middle = points.mean(axis=0)
    normal = np.linalg.svd(points - middle, full_matrices=False)[2][2]
    normal = normal if normal[2] > 0 else -normal
    return Plane(normal, float(normal @ middle))

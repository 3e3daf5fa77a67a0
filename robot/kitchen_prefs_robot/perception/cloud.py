"""Coloured points: from depth images, joined, thinned and cut."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np


@dataclass(frozen=True)
class Frame:
    """One camera's picture with depth.

    Attributes:
        colour: (H, W, 3) uint8.
        depth: Along the optical axis, (H, W) m; 0 where there is none.
        intrinsics: The camera's matrix, (3, 3) pixels; the middle of the first pixel is (.5, .5).
    """

    colour: np.ndarray
    depth: np.ndarray
    intrinsics: np.ndarray


@dataclass(frozen=True)
class Cloud:
    """Points with colours.

    Attributes:
        points: (N, 3) m.
        colours: RGB from 0 to 1, (N, 3).
    """

    points: np.ndarray
    colours: np.ndarray

    def __len__(self) -> int:
        return len(self.points)

    def where(self, chosen: np.ndarray) -> Self:
        """The points that a mask or indices choose."""
        return type(self)(self.points[chosen], self.colours[chosen])


def deproject(frame: Frame, farthest: float = np.inf) -> Cloud:
    """The points that a camera sees, in its own frame: x right, y down, z ahead.

    Args:
        frame: The picture with depth.
        farthest: Points farther ahead, m, are left out.
    """
    rows, columns = np.nonzero((frame.depth > 0) & (frame.depth <= farthest))
    ahead = frame.depth[rows, columns]  # (N,)
    pixels = np.stack([columns + 0.5, rows + 0.5, np.ones(len(rows))])  # (3, N)
    rays = np.linalg.inv(frame.intrinsics) @ pixels  # (3, N)
    return Cloud((rays * ahead).T, frame.colour[rows, columns] / 255.0)


def moved(cloud: Cloud, transform: np.ndarray) -> Cloud:
    """The cloud in another frame; `transform` is homogeneous, (4, 4)."""
    return Cloud(cloud.points @ transform[:3, :3].T + transform[:3, 3], cloud.colours)


def joined(clouds: Sequence[Cloud]) -> Cloud:
    """Several clouds as one."""
    return Cloud(
        np.concatenate([cloud.points for cloud in clouds]),
        np.concatenate([cloud.colours for cloud in clouds]),
    )


def within(points: np.ndarray, low: Sequence[float], high: Sequence[float]) -> np.ndarray:
    """Which points, (N, 3), lie between two opposite corners, (3,) m each; (N,) bool."""
    return np.all((points >= np.array(low)) & (points <= np.array(high)), axis=1)


def thinned(cloud: Cloud, side: float) -> Cloud:
    """One point for each occupied cube of a grid: the mean of its points and of their colours.

    Args:
        cloud: N points.
        side: Of the cubes, m.

    Returns:
        At most N points.
    """
    if len(cloud) == 0:
        return cloud
    cubes = np.floor(cloud.points / side).astype(np.int64)  # (N, 3)
    first, last = cubes.min(axis=0), cubes.max(axis=0)
    # One whole number a cube is sorted twenty times faster than its three.
    numbers = np.ravel_multi_index((cubes - first).T, last - first + 1)  # (N,)
    _, cube, count = np.unique(numbers, return_inverse=True, return_counts=True)
    values = np.concatenate([cloud.points, cloud.colours], axis=1)  # (N, 6)
    sums = np.stack([np.bincount(cube, column, len(count)) for column in values.T], axis=1)
    means = sums / count[:, None]
    return Cloud(means[:, :3], means[:, 3:])

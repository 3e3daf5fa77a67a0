"""Dishes seen from above, in any position, as polygons."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from kitchen_prefs.physics.shapes import CUP_CENTRE, CUP_RADIUS, HANDLE_RADIUS
from kitchen_prefs.simulation.layout import EXTENTS

# Rings round a dish's axis: the share of its half width, and the height, from -1 to 1. The first
# ones make its silhouette, then come its inside, seen from above, and its foot, seen from below.
RINGS = {
    "cup": (((1.0, 1.0), (0.95, -1.0)), (0.86, 1.0), (0.74, -1.0)),
    "glass": (((1.0, 1.0), (0.76, -1.0)), (0.84, 1.0), (0.62, -1.0)),
    "tray": (((1.0, 1.0), (1.0, -1.0)), (0.86, 1.0), (0.94, -1.0)),
    "bowl": (((1.0, 1.0), (0.86, -0.1), (0.42, -1.0)), (0.84, 1.0), (0.42, -1.0)),
    "plate": (((1.0, 1.0), (0.6, -1.0)), (0.64, 0.3), (0.6, -1.0)),
}
CIRCLE = np.linspace(0, 2 * np.pi, 40, endpoint=False)
ROUND = np.stack([np.cos(CIRCLE), np.sin(CIRCLE)], axis=1)  # (40, 2)
SQUARE = np.array([(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)])
CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])


@dataclass(frozen=True)
class Outline:
    """A dish from above, in metres.

    Attributes:
        parts: What covers the ground, from the lowest up, (n, 2) each.
        mark: The edge of its inside or of its foot, whichever is seen, (n, 2).
        inside: Whether the inside is seen.
    """

    parts: tuple[np.ndarray, ...]
    mark: np.ndarray
    inside: bool


def outline(category: str, pose: np.ndarray, scale: float = 1.0) -> Outline:
    """A dish of a category in a pose, (7,), so much larger than its category's extents."""
    rings, opening, foot = RINGS[category.split()[-1]]
    turn = Rotation.from_quat(pose[3:], scalar_first=True)
    inside = bool(turn.apply((0.0, 0.0, 1.0))[2] > 0)
    silhouette = np.concatenate([_ring(category, *ring) for ring in rings])  # (n, 3)
    solids = [*([_handle()] if category == "cup" else []), silhouette]
    mark = _ring(category, *(opening if inside else foot))  # (m, 3)
    return Outline(
        parts=tuple(_hull(turn.apply(scale * solid)[:, :2] + pose[:2]) for solid in solids),
        mark=turn.apply(scale * mark)[:, :2] + pose[:2],
        inside=inside,
    )


def surround(points: np.ndarray, distance: float) -> np.ndarray:
    """The line that goes round points, (n, 2), at a distance from them, (m, 2)."""
    return _hull((points[:, None] + distance * ROUND).reshape(-1, 2))


def _ring(category: str, share: float, height: float) -> np.ndarray:
    """A ring round a dish's axis, in the dish's frame, (n, 3)."""
    x, y, z = (extent / 2 for extent in EXTENTS[category])
    flat = (SQUARE if category == "tray" else ROUND) * share  # (n, 2)
    flat = flat * CUP_RADIUS + (CUP_CENTRE, 0.0) if category == "cup" else flat * (x, y)
    return np.column_stack([flat, np.full(len(flat), height * z)])


def _handle() -> np.ndarray:
    """The corners of the box around a cup's handle, (8, 3)."""
    end, _, height = (extent / 2 for extent in EXTENTS["cup"])
    start = CUP_CENTRE + CUP_RADIUS
    size = np.array([(end - start) / 2, HANDLE_RADIUS, 0.6 * height])
    return CORNERS * size + ((start + end) / 2, 0.0, 0.0)


def _hull(points: np.ndarray) -> np.ndarray:
    return points[ConvexHull(points).vertices]

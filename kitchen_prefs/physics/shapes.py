"""The dishes as solids: boxes, cylinders and capsules that physics can collide.

A round dish is a base and rings of twelve boxes, so it is hollow, and its outside is a regular
twelve-sided prism that stays within 2 mm of the dish's extents. A dish's frame has its origin in
the middle of the upright dish's bounding box and z up.
"""

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import atan2, cos, hypot, pi, sin, tan
from typing import Literal

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.simulation.layout import EXTENTS

SIDES = 12  # of a ring: its corners stand 3.5 % outside the circle, 5 mm on the biggest plate

# Weighed kitchenware of these sizes, in kg: stoneware, glass, beech wood.
MASSES = {
    "cup": 0.30,
    "glass": 0.20,
    "tray": 0.50,
    "small bowl": 0.25,
    "big bowl": 0.45,
    "small plate": 0.25,
    "big plate": 0.60,
}

HANDLE_RADIUS = 0.006  # of a cup's handle
CUP_RADIUS = EXTENTS["cup"][1] / 2
CUP_CENTRE = CUP_RADIUS - EXTENTS["cup"][0] / 2  # x of the cup's axis: the handle takes the rest


@dataclass(frozen=True)
class Solid:
    """One primitive of a dish, in the dish's frame.

    Attributes:
        kind: What it is; cylinders and capsules have their axis along their own z.
        size: Half lengths of a box (3), or radius and half length (2), m.
        position: Its centre, (3,) m.
        quaternion: Its rotation, (4,) wxyz.
    """

    kind: Literal["box", "cylinder", "capsule"]
    size: tuple[float, ...]
    position: tuple[float, ...]
    quaternion: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0)


@cache
def solids(category: str, scale: float = 1.0) -> tuple[Solid, ...]:
    """The primitives of a category.

    Args:
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        scale: By how much the dish is larger than its category's extents.

    Returns:
        Its solids: cup 18, glass 13, tray 5, bowl 25, plate 13.
    """
    if scale != 1:
        return tuple(_scaled(solid, scale) for solid in solids(category))
    if category == "cup":
        return _cup()
    if category == "glass":
        return _glass()
    if category == "tray":
        return _tray()
    return _bowl(category) if category.endswith("bowl") else _plate(category)


def _cup() -> tuple[Solid, ...]:
    height = EXTENTS["cup"][2]
    wall, floor = 0.005, 0.006  # thickness
    radius = CUP_RADIUS - wall / 2
    return (
        _disc(CUP_RADIUS - wall, floor, -height / 2, centre=CUP_CENTRE),
        *_ring((radius, -height / 2), (radius, height / 2), wall, centre=CUP_CENTRE),
        *_tube(cup_handle()),
    )


def cup_handle() -> np.ndarray:
    """The middle line of the cup's handle, (6, 3) m."""
    inner = CUP_CENTRE + CUP_RADIUS - HANDLE_RADIUS / 2
    outer = EXTENTS["cup"][0] / 2 - HANDLE_RADIUS
    corner = outer - 0.010
    corners = ((inner, 0.034), (corner, 0.034), (outer, 0.022))
    return np.array(
        [(x, 0.0, z) for x, z in corners] + [(x, 0.0, -z) for x, z in reversed(corners)]
    )


def _glass() -> tuple[Solid, ...]:
    width, _, height = EXTENTS["glass"]
    wall, floor, foot = 0.004, 0.008, 0.038  # the foot is narrower than the rim
    bottom, top = (foot - wall / 2, -height / 2), (width / 2 - wall / 2, height / 2)
    return (_disc(foot, floor, -height / 2), *_ring(bottom, top, wall))


def _tray() -> tuple[Solid, ...]:
    x, y, z = (extent / 2 for extent in EXTENTS["tray"])
    wall = 0.006  # half thickness
    return (
        Solid("box", (x, y, wall), (0.0, 0.0, wall - z)),
        *(Solid("box", (wall, y, z), (side * (x - wall), 0.0, 0.0)) for side in (-1, 1)),
        *(Solid("box", (x, wall, z), (0.0, side * (y - wall), 0.0)) for side in (-1, 1)),
    )


def _bowl(category: str) -> tuple[Solid, ...]:
    width, depth, height = EXTENTS[category]
    radius, wall, floor = width / 2, 0.005, 0.006
    foot = 0.42 * radius
    belly = (0.78 * radius, -0.20 * height)
    rim = (radius - wall / 2, height / 2 - wall / 4)
    stretch = (depth - width) / 2
    return (
        _disc(foot, floor, -height / 2),
        *_ring((foot, floor / 2 - height / 2), belly, wall, stretch),
        *_ring(belly, rim, wall, stretch),
    )


def _plate(category: str) -> tuple[Solid, ...]:
    width, depth, height = EXTENTS[category]
    radius, wall, floor = width / 2, 0.004, 0.005
    foot = 0.62 * radius
    rim = (radius - wall / 4, (height - wall) / 2)
    return (
        _disc(foot, floor, -height / 2),
        *_ring((foot, (floor - height) / 2), rim, wall, (depth - width) / 2),
    )


def _scaled(solid: Solid, scale: float) -> Solid:
    size, position = (tuple(scale * x for x in own) for own in (solid.size, solid.position))
    return Solid(solid.kind, size, position, solid.quaternion)


def _disc(radius: float, thickness: float, bottom: float, centre: float = 0.0) -> Solid:
    return Solid("cylinder", (radius, thickness / 2), (centre, 0.0, bottom + thickness / 2))


def _ring(
    bottom: tuple[float, float],
    top: tuple[float, float],
    thickness: float,
    stretch: float = 0.0,
    centre: float = 0.0,
) -> list[Solid]:
    """A cone's wall of twelve boxes between two points (radius, height), `stretch` wider in y."""
    rise, widening = top[1] - bottom[1], top[0] - bottom[0]
    size = (
        hypot(rise, widening) / 2,
        (max(bottom[0], top[0]) + max(stretch, 0.0)) * tan(pi / SIDES),
        thickness / 2,
    )
    radius, height = (bottom[0] + top[0]) / 2, (bottom[1] + top[1]) / 2
    boxes = []
    for side in range(SIDES):
        angle = 2 * pi * side / SIDES
        turn = Rotation.from_euler("ZY", [angle, -atan2(rise, widening)])
        position = (centre + radius * cos(angle), (radius + stretch) * sin(angle), height)
        boxes.append(Solid("box", size, position, tuple(turn.as_quat(scalar_first=True))))
    return boxes


def _tube(path: np.ndarray) -> list[Solid]:
    """The capsules along a middle line, (n, 3)."""
    tubes = []
    for start, end in pairwise(path):
        turn, _ = Rotation.align_vectors([end - start], [[0.0, 0.0, 1.0]])
        tubes.append(
            Solid(
                "capsule",
                (HANDLE_RADIUS, float(np.linalg.norm(end - start)) / 2),
                tuple((start + end) / 2),
                tuple(turn.as_quat(scalar_first=True)),
            )
        )
    return tubes


@cache
def hull_points(category: str, scale: float = 1.0) -> np.ndarray:
    """Points whose convex hull is that of the dish.

    Args:
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        scale: By how much the dish is larger than its category's extents.

    Returns:
        The outermost points of its solids, (n, 3) m.
    """
    return np.concatenate([_outermost(solid) for solid in solids(category, scale)])


def _outermost(solid: Solid) -> np.ndarray:
    """The corners of a box, or points on the rims and ends of a round solid, (n, 3)."""
    if solid.kind == "box":
        signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T
        points = signs * solid.size
    else:
        radius, half = solid.size
        angles = 2 * pi * np.arange(2 * SIDES) / (2 * SIDES)
        circle = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        rims = [np.insert(circle, 2, height, axis=1) for height in (-half, half)]
        reach = half + (radius if solid.kind == "capsule" else 0.0)
        points = np.concatenate([*rims, [[0.0, 0.0, reach], [0.0, 0.0, -reach]]])
    turn = Rotation.from_quat(solid.quaternion, scalar_first=True)
    return turn.apply(points) + solid.position

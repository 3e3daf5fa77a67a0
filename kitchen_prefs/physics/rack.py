"""A rack: a wire floor, wire walls, and tines that keep dishes apart.

The left half is for plates: two rows of long tines, closely spaced. The right half is for trays,
bowls and cups: rows of short tines with wide gaps. Both racks have the same inside, so one set of
placements serves both.
"""

import mujoco
import numpy as np

from kitchen_prefs.physics.dish_bodies import COLLISION_GROUP, FRICTION
from kitchen_prefs.simulation.layout import RACK_HEIGHT, RACK_INNER

WIRE_RADIUS = 0.0022
FLOOR_WIRE_SPACING = 0.03  # wires run along y: they also keep standing plates from rolling sideways
WALL_WIRE_SPACING = 0.068
WALL_LEVELS = (0.0, RACK_HEIGHT / 2, RACK_HEIGHT)
WALL_THICKNESS = 0.004  # half

# Rows of tines along y: x of the row, height, spacing within the row.
# Long ones hold plates, whose thickness is 20 and 26 mm; short ones leave 85 mm for a tray's 66 mm.
TINE_ROWS = (
    (-0.215, 0.080, 0.040),
    (-0.105, 0.080, 0.040),
    (0.030, 0.050, 0.085),
    (0.145, 0.050, 0.085),
)
TINE_MARGIN = 0.03  # between a row's ends and the walls


def add_wires(rack: mujoco.MjsBody) -> None:
    """Build a rack's wires and walls into a body whose origin is the middle of the rack's floor.

    Args:
        rack: The body that slides.
    """
    half_x, half_y = RACK_INNER[0] / 2, RACK_INNER[1] / 2
    for x in np.linspace(-half_x, half_x, round(2 * half_x / FLOOR_WIRE_SPACING) + 1):
        _wire(rack, (x, -half_y, -WIRE_RADIUS), (x, half_y, -WIRE_RADIUS), solid=True)
    for x, height, spacing in TINE_ROWS:
        for y in _tines_along(spacing):
            _wire(rack, (x, y, 0.0), (x, y, height), solid=True)
    _add_walls(rack, half_x, half_y)


def _tines_along(spacing: float) -> np.ndarray:
    reach = RACK_INNER[1] / 2 - TINE_MARGIN
    count = int(2 * reach / spacing) + 1
    return (np.arange(count) - (count - 1) / 2) * spacing


def _add_walls(rack: mujoco.MjsBody, half_x: float, half_y: float) -> None:
    """Visual wires, and four collision boxes behind them."""
    corners = [(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)]
    for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
        for level in WALL_LEVELS:
            _wire(rack, (*start, level), (*end, level))
        length = abs(end[0] - start[0]) + abs(end[1] - start[1])
        for x, y in np.linspace(start, end, round(length / WALL_WIRE_SPACING), endpoint=False):
            _wire(rack, (x, y, 0.0), (x, y, RACK_HEIGHT))
    for sign in (-1, 1):
        _wall(rack, (sign * (half_x + WALL_THICKNESS), 0.0), (WALL_THICKNESS, half_y))
        _wall(rack, (0.0, sign * (half_y + WALL_THICKNESS)), (half_x, WALL_THICKNESS))


def _wire(rack: mujoco.MjsBody, start: tuple, end: tuple, solid: bool = False) -> None:
    rack.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        fromto=(*start, *end),
        size=(WIRE_RADIUS, 0.0, 0.0),
        contype=int(solid),
        conaffinity=int(solid),
        friction=FRICTION,
        condim=6,
        mass=0.01,
        rgba=(0.92, 0.93, 0.94, 1.0),
    )


def _wall(rack: mujoco.MjsBody, position: tuple[float, float], size: tuple[float, float]) -> None:
    rack.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=(*position, RACK_HEIGHT / 2),
        size=(*size, RACK_HEIGHT / 2),
        friction=FRICTION,
        condim=6,
        mass=0.1,
        group=COLLISION_GROUP,
    )

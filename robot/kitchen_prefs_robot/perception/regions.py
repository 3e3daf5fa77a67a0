"""Where dishes can be: the counter, a person's hand and open drawers, each cut out of the cloud."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from kitchen_prefs_robot.perception.cloud import Cloud, joined, thinned, within
from kitchen_prefs_robot.perception.drawer_opening import drawer_opening
from kitchen_prefs_robot.perception.plane import Plane, find_plane
from kitchen_prefs_robot.scene.layout import (
    CABINET_POSITION,
    CABINET_ROTATION,
    DRAWER_FLOOR,
    DRAWER_INNER,
    DRAWERS,
)

Place = Literal["counter", "hand", "upper", "lower"]

CUBE = 0.006  # m, the side of the cubes of the thinned cloud
# m, opposite corners: where dishes stand, with a dish's radius round it. A plate on its stand ends
# at .25, and what the arm carries hangs higher than .30.
COUNTER_BOX = ((0.20, -0.62, -0.05), (0.80, 0.24, 0.30))
# Where a person shows the dish in hand: all cameras see it, and it hides no other dish.
HAND = (0.56, -0.24, 0.47)
HAND_BOX = ((0.40, -0.40, 0.38), (0.72, -0.08, 0.60))
# The cabinet and all that its drawers sweep, in its frame: no counter.
CABINET_BOX = ((-0.42, -0.25, -0.05), (0.37, 0.25, 0.60))
ABOVE = 0.015  # m over a surface that a dish's points have: four times the depth's error
# The stands are black: their sides nearly so, their lit tops a dark grey of .24. A lamp that is a
# fifth brighter or tinted moves that to .32 and makes its channels differ by a fifth.
BLACK, DARK, GREY = 0.20, 0.36, 0.25
OPEN_FROM = 0.15  # m: a drawer that is open halfway takes dishes
DRAWER_MARGIN = 0.02  # m from a drawer's walls, whose points are no dish
DRAWER_HEADROOM = 0.17  # m over a drawer's floor: the tallest dish has .13
FRONT_OF_CABINET = 0.03  # m: behind lie the cabinet's boards and the other drawer's front


def open_drawer(openings: Mapping[str, float]) -> str | None:
    """The drawer that is open, the more open one of two; None if both are closed."""
    drawer = max(openings, key=openings.__getitem__)
    return drawer if openings[drawer] >= OPEN_FROM else None


@dataclass(frozen=True)
class Regions:
    """The cloud cut into what may hold dishes.

    Attributes:
        table: The counter's plane.
        openings: How far each drawer is open, m.
        clouds: The points of dishes in each region, thinned, in the base's frame; of the drawers
            only those that are open.
        obstacles: All points above the table and in open drawers, stands included.
    """

    table: Plane
    openings: dict[str, float]
    clouds: dict[Place, Cloud]
    obstacles: Cloud


def cut_regions(cloud: Cloud, rng: np.random.Generator) -> Regions:
    """Cut a cloud, and leave out table, stands, cabinet and arm.

    Args:
        cloud: All that the cameras see, in the base's frame.
        rng: Draws the samples that find the table.

    Raises:
        NotSeenError: If the cameras see no table, or not the front of a drawer.
    """
    cabinet = Cloud(CABINET_ROTATION.inv().apply(cloud.points - CABINET_POSITION), cloud.colours)
    openings = {drawer: drawer_opening(cabinet, drawer) for drawer in DRAWERS}
    swept = within(cabinet.points, *CABINET_BOX)
    counter = thinned(cloud.where(within(cloud.points, *COUNTER_BOX) & ~swept), CUBE)
    table = find_plane(counter.points, rng)
    clouds: dict[Place, Cloud] = {
        "counter": counter.where(table.heights(counter.points) > ABOVE),
        "hand": thinned(cloud.where(within(cloud.points, *HAND_BOX)), CUBE),
    }
    for drawer in ("upper", "lower"):
        if openings[drawer] >= OPEN_FROM:
            inside = _is_inside(cabinet.points, drawer, openings[drawer])
            clouds[drawer] = thinned(cloud.where(inside), CUBE)
    obstacles = joined(list(clouds.values()))
    dishes = {place: _without_stands(region) for place, region in clouds.items()}
    return Regions(table, openings, dishes, obstacles)


def _is_inside(points: np.ndarray, drawer: str, opening: float) -> np.ndarray:
    """Which points, (N, 3) m in the cabinet's frame, lie in a drawer, off its walls and floor."""
    depth, width, _ = DRAWER_INNER
    floor, half = DRAWER_FLOOR[drawer], width / 2 - DRAWER_MARGIN
    back = max(opening - depth + DRAWER_MARGIN, FRONT_OF_CABINET)
    low = (back, -half, floor + ABOVE)
    high = (opening - DRAWER_MARGIN, half, floor + DRAWER_HEADROOM)
    return within(points, low, high)


def _without_stands(cloud: Cloud) -> Cloud:
    brightness = cloud.colours.max(axis=1)
    saturation = 1.0 - cloud.colours.min(axis=1) / np.maximum(brightness, 1e-6)
    is_stand = (brightness < BLACK) | ((brightness < DARK) & (saturation < GREY))
    return cloud.where(~is_stand)

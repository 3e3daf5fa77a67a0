"""Where the dishes of a world truly are: for reports, and for what is given to a robot as truth."""

import numpy as np

from kitchen_prefs_robot.perception.trials import SAME_DISH
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.layout import (
    CABINET_POSITION,
    CABINET_ROTATION,
    DRAWER_FLOOR,
    DRAWER_INNER,
    DRAWERS,
)

HEADROOM = 0.16  # m over a drawer's floor: dishes may lie on one another


def drawer_of(world: World, number: int) -> str | None:
    """The drawer that a dish lies in, or None."""
    position = CABINET_ROTATION.inv().apply(world.dish_pose(number)[0] - CABINET_POSITION)
    inside = (drawer for drawer in DRAWERS if _is_inside(world, position, drawer))
    return next(inside, None)


def is_on_table(world: World, number: int) -> bool:
    """Whether a dish is on the table or on its stand: in no drawer, and not on the floor."""
    return drawer_of(world, number) is None and world.dish_pose(number)[0][2] > 0.0


def nearest_on_table(world: World, place: np.ndarray) -> int | None:
    """The dish on the table that was seen at a place, (3,) m in the base's frame.

    Returns:
        The number of the dish whose middle is nearest; None if none is within `SAME_DISH`.
    """
    ways = {
        n: float(np.linalg.norm(world.dish_pose(n)[0] - place))
        for n in range(len(world.scene.dishes))
        if is_on_table(world, n)
    }
    nearest = min(ways, key=ways.__getitem__, default=None)
    return nearest if nearest is not None and ways[nearest] <= SAME_DISH else None


def highest(world: World) -> int:
    """The dish that is highest: the one in hand, where the hand holds one."""
    return max(range(len(world.scene.dishes)), key=lambda n: world.dish_pose(n)[0][2])


def _is_inside(world: World, position: np.ndarray, drawer: str) -> bool:
    """Whether a place, (3,) m in the cabinet's frame, is in a drawer, wherever that is now."""
    depth, width, _ = DRAWER_INNER
    opening, floor = world.drawer_opening(drawer), DRAWER_FLOOR[drawer]
    x, y, z = position
    return bool(
        opening - depth < x < opening and abs(y) < width / 2 and floor < z < floor + HEADROOM
    )

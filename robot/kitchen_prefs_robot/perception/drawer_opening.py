"""How far a drawer is open, measured by where its front stands in the cloud."""

import numpy as np

from kitchen_prefs_robot.perception.cloud import Cloud
from kitchen_prefs_robot.perception.not_seen import NotSeenError
from kitchen_prefs_robot.scene.layout import (
    BOARD,
    CABINET_SIZE,
    DRAWER_FLOOR,
    DRAWER_TRAVEL,
    FRONT_HEIGHT,
)

BIN = 0.01  # m: a front's points lie within twice that
SIDE_MARGIN = 0.03  # m from the front's ends, where the walls' points are
FEWEST_POINTS = 60  # of a front: the cameras see a thousand and more at 320 x 240


def drawer_opening(cloud: Cloud, drawer: str) -> float:
    """Measure how far a drawer is open.

    Args:
        cloud: All points, in the cabinet's frame.
        drawer: "upper" or "lower".

    Returns:
        The opening in m.

    Raises:
        NotSeenError: If the cameras do not see the drawer's front.
    """
    x, y, z = cloud.points.T
    low = DRAWER_FLOOR[drawer]
    half = CABINET_SIZE[1] / 2 - SIDE_MARGIN
    on_front = (abs(y) < half) & (z > low) & (z < low + FRONT_HEIGHT - 2 * BOARD)
    ahead = x[on_front & (x > -BIN) & (x < DRAWER_TRAVEL + 3 * BIN)]
    counts, edges = np.histogram(ahead, np.arange(-BIN, DRAWER_TRAVEL + 4 * BIN, BIN))
    if counts.max() < FEWEST_POINTS:
        raise NotSeenError(
            f"The cameras do not see the front of the {drawer} drawer; clear the view."
        )
    peak = edges[counts.argmax()] + BIN / 2
    front = float(np.median(ahead[abs(ahead - peak) < 1.5 * BIN]))
    return float(np.clip(front - BOARD, 0.0, DRAWER_TRAVEL))

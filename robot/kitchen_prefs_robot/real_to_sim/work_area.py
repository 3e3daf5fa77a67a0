"""Maps from the robot's base to the kitchen, one for each work area: counter, upper, lower.

A map is the paper's: two scales and two shifts, by least squares from corresponding corners. The
paper's formula has no rotation, so it needs axes that are parallel; this table's cabinet is turned
by 45 degrees in the base's frame. So each area's corners are first turned by the angle between
their sides and the kitchen's.

    base (x, y) -> turned (u, v) -> kitchen (scale_x u + shift_x, scale_y v + shift_y)
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.simulation import layout as kitchen
from kitchen_prefs_robot.scene import layout as table
from kitchen_prefs_robot.task.rows import RACK_OF

AREAS = ("counter", "upper", "lower")
CORNER_NOISE = 0.003  # m, standard deviation of a corner that a person measures with the arm's tip


@dataclass(frozen=True)
class WorkArea:
    """The map of one work area.

    Attributes:
        yaw: Turns the base's axes to be parallel to the kitchen's, radians.
        scale: Of x and y, (2,).
        shift: Of x and y, (2,) m.
        residual: Root mean square distance of the corners after the map, m.
    """

    yaw: float
    scale: tuple[float, float]
    shift: tuple[float, float]
    residual: float

    def to_kitchen(self, points: np.ndarray) -> np.ndarray:
        """Points of the table, (..., 2) m in the base's frame, in the kitchen's, (..., 2) m.

        The height is looked up, see `conversion`.
        """
        return _turned(points, self.yaw) * self.scale + self.shift


def fit_work_area(corners: np.ndarray, kitchen_corners: np.ndarray) -> WorkArea:
    """Fit the map of a work area.

    Args:
        corners: Measured in the base's frame, in order round the area, (N, 2) m, N >= 3.
        kitchen_corners: The corresponding ones in the kitchen, (N, 2) m.
    """
    yaw = _angle_between(corners, kitchen_corners)
    turned = _turned(corners, yaw)
    count = len(corners)
    # Rows: [x, 0, 1, 0] for the kitchen's x and [0, y, 0, 1] for its y, a pair for each corner.
    pairs = np.zeros((count, 2, 4))
    pairs[:, 0, 0], pairs[:, 1, 1] = turned.T
    pairs[:, 0, 2] = pairs[:, 1, 3] = 1.0
    system = pairs.reshape(2 * count, 4)
    solution = np.linalg.lstsq(system, kitchen_corners.ravel(), rcond=None)[0]  # (4,)
    errors = (system @ solution - kitchen_corners.ravel()).reshape(count, 2)
    residual = float(np.sqrt((errors**2).sum(axis=1).mean()))
    scale_x, scale_y, shift_x, shift_y = map(float, solution)
    return WorkArea(yaw, (scale_x, scale_y), (shift_x, shift_y), residual)


def measure_work_areas(
    noise: float = CORNER_NOISE,
    seed: int = 0,
    corners: Mapping[str, np.ndarray] | None = None,
) -> dict[str, WorkArea]:
    """Measure the three work areas, and fit their maps.

    Args:
        noise: Standard deviation of a measured corner's coordinates, m.
        seed: Draws the errors.
        corners: Of each area in the base's frame, (4, 2) m, in the order of `table_corners`, which
            are taken by default.

    Returns:
        The map of each area of AREAS.
    """
    rng = np.random.default_rng(seed)
    known, target = corners or table_corners(), kitchen_corners()
    return {
        area: fit_work_area(known[area] + noise * rng.standard_normal((4, 2)), target[area])
        for area in AREAS
    }


def table_corners() -> dict[str, np.ndarray]:
    """The true corners of the work areas, (4, 2) m each in the base's frame.

    The counter's as the robot sees them: near right, far right, far left, near left. An open
    drawer's as seen from before it: front left, back left, back right, front right.
    """
    (near, far), (right, left) = table.COUNTER_X, table.COUNTER_Y
    depth, width, _ = table.DRAWER_INNER
    front, half = table.DRAWER_TRAVEL, width / 2
    inner = np.array(
        [(front, -half, 0), (front - depth, -half, 0), (front - depth, half, 0), (front, half, 0)]
    )
    drawer = table.from_cabinet(inner)[:, :2]
    counter = np.array([(near, right), (far, right), (far, left), (near, left)])
    return {"counter": counter, "upper": drawer, "lower": drawer}


def kitchen_corners() -> dict[str, np.ndarray]:
    """The corresponding corners in the kitchen, (4, 2) m each.

    The counter is its part to the right of the sink, next to the dishwasher; the person stands
    before it as the robot does. The racks are pulled out.
    """
    left = kitchen.SINK_CENTRE[0] + kitchen.SINK_SIZE[0] / 2
    right, (near, far) = kitchen.COUNTER_X[1], kitchen.COUNTER_Y
    corners = {"counter": np.array([(right, near), (right, far), (left, far), (left, near)])}
    for drawer, rack in RACK_OF.items():
        x, y, _ = kitchen.RACK_CLOSED[rack]
        half = np.array(kitchen.RACK_INNER) / 2
        signs = np.array([(-1, -1), (-1, 1), (1, 1), (1, -1)])
        corners[drawer] = np.array([x, y - kitchen.RACK_TRAVEL]) + half * signs
    return corners


def _turned(points: np.ndarray, yaw: float) -> np.ndarray:
    return points @ Rotation.from_euler("z", yaw).as_matrix()[:2, :2].T


def _angle_between(corners: np.ndarray, others: np.ndarray) -> float:
    """The mean angle from the sides of one polygon to those of another, radians."""
    sides, other_sides = (np.roll(c, -1, axis=0) - c for c in (corners, others))
    first, second = (side[:, 0] + 1j * side[:, 1] for side in (sides, other_sides))
    turns = second / first
    return float(np.angle((turns / abs(turns)).sum()))

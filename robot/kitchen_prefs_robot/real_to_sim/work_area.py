"""The map from the robot's base to the kitchen, of the work area where dishes stand: the counter.

It is the paper's: two scales and two shifts, by least squares from corresponding corners. The
paper's formula has no rotation, so it needs axes that are parallel; this table's counter is turned
by 90 degrees in the base's frame. So its corners are first turned by the angle between their sides
and the kitchen's. The drawers need no map: a dish in one has the drop pose, as in the paper.

    base (x, y) -> turned (u, v) -> kitchen (scale_x u + shift_x, scale_y v + shift_y)
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.simulation import layout as kitchen
from kitchen_prefs_robot.scene import layout as table

CORNER_NOISE = 0.003  # m, standard deviation of a corner that a person measures with the arm's tip


@dataclass(frozen=True)
class WorkArea:
    """The map of a work area.

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


def measure_counter(noise: float = CORNER_NOISE, seed: int = 0) -> WorkArea:
    """Measure the counter's corners, and fit its map.

    Args:
        noise: Standard deviation of a measured corner's coordinates, m.
        seed: Draws the errors.
    """
    errors = noise * np.random.default_rng(seed).standard_normal((4, 2))
    return fit_work_area(table_corners() + errors, kitchen_corners())


def table_corners() -> np.ndarray:
    """The counter's true corners, (4, 2) m in the base's frame.

    As the robot sees them: near right, far right, far left, near left.
    """
    (near, far), (right, left) = table.COUNTER_X, table.COUNTER_Y
    return np.array([(near, right), (far, right), (far, left), (near, left)])


def kitchen_corners() -> np.ndarray:
    """The corresponding corners in the kitchen, (4, 2) m.

    They are of the part of its counter to the right of the sink, next to the dishwasher; the person
    stands before it as the robot does.
    """
    left = kitchen.SINK_CENTRE[0] + kitchen.SINK_SIZE[0] / 2
    right, (near, far) = kitchen.COUNTER_X[1], kitchen.COUNTER_Y
    return np.array([(right, near), (right, far), (left, far), (left, near)])


def _turned(points: np.ndarray, yaw: float) -> np.ndarray:
    return points @ Rotation.from_euler("z", yaw).as_matrix()[:2, :2].T


def _angle_between(corners: np.ndarray, others: np.ndarray) -> float:
    """The mean angle from the sides of one polygon to those of another, radians."""
    sides, other_sides = (np.roll(c, -1, axis=0) - c for c in (corners, others))
    first, second = (side[:, 0] + 1j * side[:, 1] for side in (sides, other_sides))
    turns = second / first
    return float(np.angle((turns / abs(turns)).sum()))

"""The measures of table, cabinet and counter, in metres, in the frame of the robot's base.

x points away from the robot, y to its left, z up from the table. The cabinet has a frame of its
own: its origin is the middle of its front on the table, x points out of it, towards the robot.
"""

from math import pi

import numpy as np
from scipy.spatial.transform import Rotation

TABLE_X, TABLE_Y = (-0.40, 1.12), (-0.95, 1.12)
TABLE_THICKNESS = 0.04
FLOOR = -0.74  # z

# The part of the table where dishes stand: their centres lie in it.
COUNTER_X, COUNTER_Y = (0.34, 0.62), (-0.46, 0.06)
LONGEST_REACH = 0.70  # of a dish's centre from the base's axis: the arm still grasps it from above

DRAWERS = ("upper", "lower")
CABINET_AZIMUTH = pi / 4
CABINET_DISTANCE = 0.80  # of its front from the base's axis
CABINET_SIZE = (0.40, 0.44, 0.453)  # depth, width, height
BOARD = 0.018  # thickness of the cabinet's boards
DRAWER_INNER = (0.30, 0.36, 0.10)  # depth, width, height of its walls
DRAWER_WALL = 0.008
DRAWER_FLOOR = {"upper": 0.250, "lower": 0.035}  # z of the floor's upper side
DRAWER_TRAVEL = 0.28  # further, and the arm would have to fold more than it can
FRONT_HEIGHT = 0.155  # of a drawer's front, which leaves a gap: a dish passes over it
HANDLE_OUT = 0.075  # from the front's inside to the bar's axis: room for a finger in between
HANDLE_UP = 0.070  # from the drawer's floor to the bar's axis
HANDLE_RADIUS, HANDLE_LENGTH = 0.006, 0.12

STAND_RADIUS, STAND_HEIGHT = 0.045, 0.22  # a column: the arm cannot reach under a plate below it

_TURN = CABINET_AZIMUTH + pi  # its x axis points at the base
CABINET_POSITION = CABINET_DISTANCE * np.array(
    [np.cos(CABINET_AZIMUTH), np.sin(CABINET_AZIMUTH), 0]
)
CABINET_ROTATION = Rotation.from_euler("z", _TURN)


def from_cabinet(points: np.ndarray) -> np.ndarray:
    """Points in the cabinet's frame, (..., 3) m, in the base's frame."""
    points = np.asarray(points, dtype=float)
    return CABINET_ROTATION.apply(points.reshape(-1, 3)).reshape(points.shape) + CABINET_POSITION


def handle_position(drawer: str, opening: float) -> np.ndarray:
    """The middle of a drawer's handle where the drawer is `opening` m open, (3,) m."""
    return from_cabinet(np.array([opening + HANDLE_OUT, 0.0, DRAWER_FLOOR[drawer] + HANDLE_UP]))

"""The room that the open hand takes, as boxes in its own frame.

Measured on the gripper's collision meshes. x runs along the fingers' width, y from finger to
finger, z out of the hand; the origin lies between the fingertips.
"""

import numpy as np

HALF_OPENING = 0.0426  # m from the middle to a fingertip's inside
PAD_HALF_WIDTH = 0.011  # m
TIP = 0.0047  # m beyond the origin where the hand is open ...
CLOSED_TIP = 0.0176  # ... and where it is closed, because the fingers swing forward

# Lowest and highest corner of each box: fingertips, fingers, palm, the arm's last link.
_RIGHT = (
    ((-0.011, HALF_OPENING, -0.033), (0.011, 0.056, TIP)),
    ((-0.020, 0.046, -0.10), (0.020, 0.075, -0.005)),
)
_MIDDLE = (
    ((-0.040, -0.075, -0.16), (0.040, 0.075, -0.070)),
    ((-0.060, -0.060, -0.27), (0.060, 0.060, -0.16)),
)


def _mirrored(box: tuple[tuple[float, ...], tuple[float, ...]]) -> np.ndarray:
    """The box on the other side, (2, 3)."""
    (x0, y0, z0), (x1, y1, z1) = box
    return np.array([(x0, -y1, z0), (x1, -y0, z1)])


BOXES = np.array([*_RIGHT, *map(_mirrored, _RIGHT), *_MIDDLE])  # (6, 2, 3)
BOXES_REACH = np.abs(BOXES).max(axis=(0, 1))  # (3,)
_CHOICE = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])
_OPEN_CORNERS = np.concatenate([box[_CHOICE, [0, 1, 2]] for box in BOXES])
_CLOSED_TIPS = np.array([(x, 0.0, CLOSED_TIP) for x in (-PAD_HALF_WIDTH, PAD_HALF_WIDTH)])
CORNERS = np.concatenate([_OPEN_CORNERS, _CLOSED_TIPS])  # (50, 3)


def struck(points: np.ndarray) -> int:
    """How many points, (N, 3) in the hand's frame, the open hand would strike."""
    near = (np.abs(points) < BOXES_REACH).all(axis=1)
    local = points[near, None]
    inside = ((local > BOXES[:, 0]) & (local < BOXES[:, 1])).all(axis=2)
    return int(np.any(inside, axis=1).sum())


def lowest(pose: np.ndarray) -> float:
    """The height of the hand's lowest corner, m, open or closed, at a pose (4, 4)."""
    return float((CORNERS @ pose[2, :3]).min() + pose[2, 3])

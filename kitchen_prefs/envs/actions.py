"""An action is a pose, and a pose chooses a row of the instance set."""

from collections.abc import Sequence

import numpy as np

from kitchen_prefs import instances

METRES_PER_RADIAN = 0.1  # weight of a rotation in the distance between two poses


def nearest_row(rows: np.ndarray, action: np.ndarray | Sequence[float]) -> tuple[int, float]:
    """The row that an action chooses.

    Args:
        rows: The instance set, (n, 13).
        action: A pose: position (m) and quaternion (wxyz), (7,).

    Returns:
        The nearest row that the decision may choose, the lowest on a tie, and its distance:
        |position difference| in m + 0.1 x the angle between the rotations in rad.

    Raises:
        ValueError: If the action has another shape or is not finite.
    """
    action = np.asarray(action, dtype=np.float64)
    if action.shape != (7,):
        raise ValueError(
            f"An action is a pose of 7 numbers (x y z qw qx qy qz); this one has {action.shape}."
        )
    if not np.isfinite(action).all():
        raise ValueError("An action must be finite; this one holds NaN or infinity.")
    candidates = np.flatnonzero(instances.choosable(rows))  # (c,)
    poses = rows[candidates, instances.POSE].astype(np.float64)  # (c, 7)
    metres = np.linalg.norm(poses[:, :3] - action[:3], axis=1)  # (c,)
    lengths = np.linalg.norm(poses[:, 3:], axis=1) * max(np.linalg.norm(action[3:]), 1e-12)
    cosine = np.abs(poses[:, 3:] @ action[3:]) / lengths  # q and -q are one rotation
    distance = metres + METRES_PER_RADIAN * 2 * np.arccos(np.clip(cosine, 0, 1))  # (c,)
    nearest = int(distance.argmin())
    return int(candidates[nearest]), float(distance[nearest])

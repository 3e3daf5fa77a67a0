"""Grasps from points: where the two fingers can press on a thin wall from both sides.

A dish is held by its wall: by a rim, or by a handle. The surface's normal at a point says along
which line the fingers close; the hand comes along the wall, over its nearest edge. No model of the
dish is used, so the points may be seen from a few sides alone.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from kitchen_prefs_robot.motion import hand
from kitchen_prefs_robot.motion.kinematics import hand_pose

DOWN = np.array([0.0, 0.0, -1.0])
MOST_POINTS = 1500  # of the object and of the others each; more give no better grasps
NEIGHBOURS = 20  # points that give a normal
SAMPLES = 120  # points at which a grasp is tried
TURNS = np.deg2rad([0.0, -25.0, 25.0])  # of the approach about the closing line
STEEPEST, FLATTEST = 0.0, np.deg2rad(68.0)  # tilt of the approach from straight down
DEPTH = 0.012  # m that the fingertips reach beyond the wall's edge
FEWEST = 8  # points between the fingers
WIDEST = 0.05  # m between the fingers: the rest is for errors
STRUCK_OWN, STRUCK_OTHERS = 0.01, 0.0  # share of the points that the open hand may touch
CLEARANCE = 0.003  # m from the table


@dataclass(frozen=True)
class Grasp:
    """A pose of the hand from which closing the fingers should hold the object.

    Attributes:
        pose: Of the hand, (4, 4).
        confidence: From 0 to 1: how squarely the fingers press, and how thin the wall is.
    """

    pose: np.ndarray
    confidence: float

    @property
    def tilt(self) -> float:
        """The angle of the approach from straight down, radians."""
        return float(np.arccos(np.clip(-self.pose[2, 2], -1.0, 1.0)))


def propose_grasps(points: np.ndarray, others: np.ndarray) -> list[Grasp]:
    """All grasps that strike nothing, the most confident first.

    Args:
        points: Of the object, (N, 3) m in the base's frame; from one side or from all.
        others: Of everything else above the table, (M, 3).

    Returns:
        The grasps; none where the points are too few or stand too close to others.
    """
    rng = np.random.default_rng(0)
    points, others = _thinned(points, rng), _thinned(others, rng)
    if len(points) < NEIGHBOURS:
        return []
    normals = _normals(points)
    grasps = []
    for index in rng.permutation(len(points))[:SAMPLES]:
        for turn in TURNS:
            approach = _approach(normals[index], turn)
            if approach is None:
                continue
            grasp = _grasp(points, normals, index, approach)
            if grasp is not None and _is_free(grasp.pose, points, others):
                grasps.append(grasp)
    return sorted(grasps, key=lambda grasp: -grasp.confidence)


def _thinned(points: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    points = np.asarray(points, dtype=float).reshape(-1, 3)
    return points[rng.permutation(len(points))[:MOST_POINTS]]


def _normals(points: np.ndarray) -> np.ndarray:
    """The direction across the surface at each point, (N, 3), of either sign."""
    _, nearest = cKDTree(points).query(points, NEIGHBOURS)
    patches = points[nearest] - points[nearest].mean(axis=1, keepdims=True)
    _, axes = np.linalg.eigh(patches.swapaxes(1, 2) @ patches)
    return axes[:, :, 0]


def _approach(normal: np.ndarray, turn: float) -> np.ndarray | None:
    """The way down along a wall, turned about the wall's normal; None where it is too flat."""
    down = DOWN - (DOWN @ normal) * normal
    length = np.linalg.norm(down)
    if length < 0.1:  # the wall lies level
        return None
    down /= length
    approach = np.cos(turn) * down + np.sin(turn) * np.cross(normal, down)
    return approach if np.arccos(-approach[2]) < FLATTEST else None


def _grasp(
    points: np.ndarray, normals: np.ndarray, index: int, approach: np.ndarray
) -> Grasp | None:
    """The grasp of the wall at a point, over the wall's edge; None where it is no thin wall."""
    pose = hand_pose(points[index], approach, normals[index])
    local = (points - pose[:3, 3]) @ pose[:3, :3]
    between = (np.abs(local[:, 0]) < hand.PAD_HALF_WIDTH) & (
        np.abs(local[:, 1]) < hand.HALF_OPENING
    )
    if between.sum() < FEWEST:
        return None
    edge = np.quantile(local[between, 2], 0.03)
    held = between & (local[:, 2] < edge + DEPTH + hand.CLOSED_TIP)
    if held.sum() < FEWEST:
        return None
    low, high = np.quantile(local[held, 1], (0.05, 0.95))
    if high - low > WIDEST:
        return None
    pose[:3, 3] += pose[:3, :3] @ (0.0, (low + high) / 2, edge + DEPTH)
    squareness = np.abs(normals[held] @ normals[index]).mean()
    return Grasp(pose, float(squareness * (1.0 - (high - low) / (2 * hand.HALF_OPENING))))


def _is_free(pose: np.ndarray, points: np.ndarray, others: np.ndarray) -> bool:
    """Whether the open hand touches neither the object, nor others, nor the table."""
    own, foreign = ((p - pose[:3, 3]) @ pose[:3, :3] for p in (points, others))
    return (
        hand.lowest(pose) > CLEARANCE
        and hand.struck(own) <= STRUCK_OWN * len(points)
        and hand.struck(foreign) <= STRUCK_OTHERS * len(others)
    )

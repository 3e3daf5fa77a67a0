"""Where the arm's joints must be so that the hand is where it should be.

The hand's frame is the gripper's pinch: its origin lies between the fingertips, z points out of the
hand, y from one fingertip to the other. A pose is a (4, 4) matrix in the frame of the base.
"""

from collections.abc import Iterator
from functools import cache

import mink
import numpy as np

from kitchen_prefs_robot.scene.arm import HOME, PINCH, arm_kinematics

TOLERANCE = (0.001, 0.01)  # m and radians by which a solution may miss its pose
ITERATIONS = 25  # of one start: 99 of 100 starts that lead to a pose need fewer
FOLLOWING = 8  # iterations from one pose of a line to the next; most need one
# Radians that turn the first and the last joint of a start: the hand has two sides.
STARTS = ((0.0, 0.0), (0.0, np.pi / 2), (0.0, -np.pi / 2), (0.5, 0.0), (-0.5, 0.0))
# A quick test before the search: the wrist, behind the hand, lies within the arm's length, m.
SHOULDER, ARM_LENGTH, HAND_LENGTH = np.array([0.0, 0.0, 0.333]), 0.81, 0.256
SAME = 0.1  # radians between solutions that are one
MARGIN = 0.03  # radians from the joints' limits
JUMP = 0.5  # radians that no joint moves from one pose of a line to the next


class Kinematics:
    """Inverse kinematics of the arm alone, by mink's differential solver."""

    def __init__(self) -> None:
        model = arm_kinematics().compile()
        self._configuration = mink.Configuration(model)
        self._hand = mink.FrameTask(
            PINCH, "site", position_cost=1.0, orientation_cost=0.2, lm_damping=1e-4
        )
        self._posture = mink.PostureTask(model, cost=1e-4)
        self._posture.set_target(np.array(HOME))
        self._limits = [mink.ConfigurationLimit(model, min_distance_from_limits=MARGIN)]

    def pose(self, joints: np.ndarray) -> np.ndarray:
        """Where the hand is, (4, 4), with the joints at given angles, (7,)."""
        self._configuration.update(np.asarray(joints, dtype=float))
        return self._configuration.get_transform_frame_to_world(PINCH, "site").as_matrix()

    def reach(self, pose: np.ndarray, near: np.ndarray) -> Iterator[np.ndarray]:
        """Search for joints that put the hand at a pose.

        Args:
            pose: Of the hand, (4, 4).
            near: The joints from which the arm will move there, (7,).

        Yields:
            Solutions that differ, (7,) each, those with the smallest moves first as a rule; none
            out of reach.
        """
        if np.linalg.norm(pose[:3, 3] - HAND_LENGTH * pose[:3, 2] - SHOULDER) > ARM_LENGTH:
            return
        found: list[np.ndarray] = []
        for start in _starts(pose, near):
            joints = self._solve(pose, start, ITERATIONS)
            if joints is not None and not any(np.allclose(joints, f, atol=SAME) for f in found):
                found.append(joints)
                yield joints

    def line(self, poses: np.ndarray, start: np.ndarray) -> np.ndarray | None:
        """Joints that lead the hand through poses that lie close to one another.

        Args:
            poses: (N, 4, 4).
            start: The joints at the first pose, (7,).

        Returns:
            The joints of each pose, (N, 7), or None where the arm cannot follow.
        """
        joints, path = start, []
        for pose in poses:
            following = self._solve(pose, joints, FOLLOWING)
            if following is None or np.abs(following - joints).max() > JUMP:
                return None
            joints = following
            path.append(joints)
        return np.array(path)

    def _solve(self, pose: np.ndarray, start: np.ndarray, iterations: int) -> np.ndarray | None:
        self._configuration.update(start)
        self._hand.set_target(mink.SE3.from_matrix(pose))
        for _ in range(iterations):
            error = self._hand.compute_error(self._configuration)
            if (
                np.linalg.norm(error[:3]) < TOLERANCE[0]
                and np.linalg.norm(error[3:]) < TOLERANCE[1]
            ):
                return self._configuration.q.copy()
            velocity = mink.solve_ik(
                self._configuration,
                [self._hand, self._posture],
                dt=1.0,
                solver="daqp",
                limits=self._limits,
            )
            self._configuration.integrate_inplace(velocity, 1.0)
        return None


@cache
def kinematics() -> Kinematics:
    """The one solver of a process."""
    return Kinematics()


def _starts(pose: np.ndarray, near: np.ndarray) -> list[np.ndarray]:
    """Where the search begins: at home with the arm turned towards the pose, and here."""
    azimuth = np.arctan2(pose[1, 3], pose[0, 3])
    starts = []
    for first, last in STARTS:
        start = np.array(HOME)
        start[0], start[6] = azimuth + first, start[6] + last
        starts.append(start)
    return [starts[0], np.asarray(near, dtype=float), *starts[1:]]


def hand_pose(position: np.ndarray, approach: np.ndarray, closing: np.ndarray) -> np.ndarray:
    """The hand's pose, (4, 4).

    Args:
        position: Of the point between the fingertips, (3,) m.
        approach: The unit vector out of the hand, (3,).
        closing: The unit vector from fingertip to fingertip, across `approach`, (3,).
    """
    pose = np.eye(4)
    pose[:3, :3] = np.stack([np.cross(closing, approach), closing, approach], axis=1)
    pose[:3, 3] = position
    return pose


def turned_over(pose: np.ndarray) -> np.ndarray:
    """The same grasp with the fingers exchanged, (4, 4)."""
    return pose @ np.diag([-1.0, -1.0, 1.0, 1.0])

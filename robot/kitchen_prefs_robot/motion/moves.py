"""Moves of the arm: minimum-jerk paths, followed at 50 Hz under contact physics."""

from collections.abc import Callable

import numpy as np
from scipy.spatial.transform import Rotation, Slerp

from kitchen_prefs_robot.motion.kinematics import kinematics
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.arm import ARM_JOINTS, CLOSED, FINGER, HOME, OPEN

OnFrame = Callable[[World], None]

PERIOD = 0.02  # s from one command to the next: 50 Hz
JOINT_SPEED = 1.6  # rad / s at most; the real arm's joints manage 2.1
HAND_SPEED = 0.35  # m / s at most on a straight line
PEAK = 1.875  # the highest speed of a minimum-jerk move, as a multiple of its mean
SHORTEST = 0.4  # s of a move
STEP = 0.02  # m between two poses of a planned line; between them it bends by .1 mm
WAITING = 0.6  # s after a move until the arm must have arrived
ARRIVED = 0.02  # radians that each joint may be away
GRIPPING = 0.6  # s until the fingers have closed on something
OPENING, SHUT = 0.085, 0.80  # m between the open fingertips, and the finger's angle when they meet


class Arm:
    """The arm of a world: what it can feel, and how it moves.

    Args:
        world: In which it moves.
        on_frame: Called with the world after each command, 50 times a simulated second.
    """

    def __init__(self, world: World, on_frame: OnFrame | None = None) -> None:
        self.world = world
        self._on_frame = on_frame

    @property
    def joints(self) -> np.ndarray:
        """The measured angles, (7,) radians."""
        return np.array([self.world.data.joint(name).qpos[0] for name in ARM_JOINTS])

    @property
    def target(self) -> np.ndarray:
        """The angles last commanded, (7,) radians."""
        return self.world.data.ctrl[:7].copy()

    @property
    def grip(self) -> float:
        """The distance between the fingertips, m, as the gripper measures it."""
        angle = float(self.world.data.joint(FINGER).qpos[0])
        return OPENING * max(1.0 - angle / SHUT, 0.0)

    def follow(self, path: np.ndarray) -> bool:
        """Send the joints along a path, (N, 7), 50 of them a second.

        Returns:
            Whether the arm has arrived; something is in its way otherwise.
        """
        for joints in path:
            self._command(joints)
        for _ in range(round(WAITING / PERIOD)):
            if np.abs(self.joints - path[-1]).max() < ARRIVED:
                return True
            self._command(path[-1])
        return False

    def go_home(self) -> bool:
        """Move back over the near edge of the counter."""
        return self.follow(joint_path(self.target, np.array(HOME)))

    def open_fingers(self, control: float = OPEN) -> None:
        """Open the gripper: wide, or to one of its controls between open and closed."""
        self._grip(control)

    def close_fingers(self) -> None:
        """Close the gripper, on what is between its fingers or on nothing."""
        self._grip(CLOSED)

    def _grip(self, control: float) -> None:
        self.world.data.ctrl[7] = control
        for _ in range(round(GRIPPING / PERIOD)):
            self._command(self.target)

    def _command(self, joints: np.ndarray) -> None:
        self.world.data.ctrl[:7] = joints
        self.world.advance(PERIOD)
        if self._on_frame is not None:
            self._on_frame(self.world)


def joint_path(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """A minimum-jerk move of all joints at once, (N, 7)."""
    duration = PEAK * np.abs(end - start).max() / JOINT_SPEED
    return start + _progress(duration)[:, None] * (end - start)


def line_path(start: np.ndarray, *ends: np.ndarray) -> np.ndarray | None:
    """A minimum-jerk move of the hand along straight lines, from rest to rest on each.

    Args:
        start: The joints at the start, (7,).
        ends: The hand's poses at the end of each line, (4, 4); it turns evenly on its way.

    Returns:
        The joints, (N, 7), or None where the arm cannot follow.
    """
    paths = []
    for end in ends:
        path = _one_line(start, end)
        if path is None:
            return None
        paths.append(path)
        start = path[-1]
    return np.concatenate(paths)


def _one_line(start: np.ndarray, end: np.ndarray) -> np.ndarray | None:
    solver = kinematics()
    first = solver.pose(start)
    length = float(np.linalg.norm(end[:3, 3] - first[:3, 3]))
    shares = np.linspace(0.0, 1.0, max(2, 1 + int(np.ceil(length / STEP))))
    turns = Slerp([0.0, 1.0], Rotation.from_matrix(np.stack([first[:3, :3], end[:3, :3]])))
    poses = np.tile(np.eye(4), (len(shares), 1, 1))
    poses[:, :3, :3] = turns(shares).as_matrix()
    poses[:, :3, 3] = first[:3, 3] + shares[:, None] * (end[:3, 3] - first[:3, 3])
    joints = solver.line(poses, start)
    if joints is None:
        return None
    fastest = np.abs(np.diff(joints, axis=0)).max() * (len(shares) - 1)
    progress = _progress(PEAK * max(length / HAND_SPEED, fastest / JOINT_SPEED))
    return np.stack([np.interp(progress, shares, angles) for angles in joints.T], axis=1)


def _progress(duration: float) -> np.ndarray:
    """The share of a minimum-jerk move that is done at each command, (N,), ending at 1."""
    steps = int(np.ceil(max(duration, SHORTEST) / PERIOD))
    time = np.arange(1, steps + 1) / steps
    return time**3 * (10.0 - 15.0 * time + 6.0 * time**2)

"""Pick a dish: choose a grasp, come from above, approach on a straight line, close, lift."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from kitchen_prefs_robot.motion.grasps import Grasp, propose_grasps
from kitchen_prefs_robot.motion.kinematics import kinematics, turned_over
from kitchen_prefs_robot.motion.moves import Arm, OnFrame, joint_path, line_path
from kitchen_prefs_robot.motion.obstacles import Furniture, Obstacles
from kitchen_prefs_robot.motion.outcomes import Outcome, Result
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.arm import HOME

MOST_CONFIDENT = 5  # reachable grasps, of which the most top-down is taken (the paper's choice)
TRIED = 60  # grasps whose path is planned at most
PRE_GRASP = 0.10  # m back along the approach
LIFT = 0.12  # m straight up, until nothing on the table is in the way
CARRY = (0.45, 0.52)  # m from the base's axis and above the table, where a pick ends
MOST_HELD = 100  # points that stand for what the hand holds
EMPTY = 0.0022  # m between the fingertips: less than the thinnest dish's wall


@dataclass(frozen=True)
class PickOutcome(Outcome):
    """The end of a pick.

    Attributes:
        held: Points of the object in the hand's frame, (K, 3) m; none where nothing is held.
        way: The joints' path from the grasp to where the pick ended, (N, 7), likewise.
    """

    held: np.ndarray
    way: np.ndarray


@dataclass(frozen=True)
class _Plan:
    """A grasp with the joints' paths to it and away from it."""

    grasp: Grasp
    before: np.ndarray
    approach: np.ndarray
    lift: np.ndarray

    @property
    def path(self) -> np.ndarray:
        """All of it."""
        return np.concatenate([self.before, self.approach, self.lift])


def pick(
    world: World,
    points: np.ndarray,
    others_points: np.ndarray,
    furniture: Furniture | None = None,
    on_frame: OnFrame | None = None,
) -> PickOutcome:
    """Pick the object that some points belong to.

    Args:
        world: In which the arm moves; its hand is empty.
        points: Of the object as it was seen, (N, 3) m in the base's frame.
        others_points: Of all else above the table, (M, 3).
        furniture: What is known of drawers and stands; by default all, as it truly is.
        on_frame: Called with the world 50 times a simulated second.

    Returns:
        How it ended. The arm holds the object over the counter where it is done, and is at home
        otherwise.
    """
    arm, started = Arm(world, on_frame), world.data.time
    obstacles = Obstacles(world, furniture or Furniture.true(world))
    plan = _plan(arm.target, points, others_points, obstacles)
    if plan is None:
        return _nothing_held(Result.UNREACHABLE, 0.0)
    result = _execute(arm, plan)
    if result is not Result.DONE:
        arm.open_fingers()
        arm.go_home()
        return _nothing_held(result, world.data.time - started)
    pose = plan.grasp.pose
    held = (points[:: 1 + len(points) // MOST_HELD] - pose[:3, 3]) @ pose[:3, :3]
    return PickOutcome(result, world.data.time - started, held, plan.lift)


def put_back(world: World, picked: PickOutcome, on_frame: OnFrame | None = None) -> Outcome:
    """Put what a pick has grasped back to where it stood, for want of a place to drop it.

    Args:
        world: In which the arm has not moved since the pick.
        picked: Its outcome.
        on_frame: Called with the world 50 times a simulated second.

    Returns:
        How it ended; the arm is at home.
    """
    arm, started = Arm(world, on_frame), world.data.time
    arrived = arm.follow(picked.way[::-1])
    arm.open_fingers()
    arm.follow(picked.way)
    arm.go_home()
    return Outcome(Result.DONE if arrived else Result.TIMED_OUT, world.data.time - started)


def _nothing_held(result: Result, seconds: float) -> PickOutcome:
    return PickOutcome(result, seconds, np.empty((0, 3)), np.empty((0, 7)))


def _plan(
    start: np.ndarray, points: np.ndarray, others: np.ndarray, obstacles: Obstacles
) -> _Plan | None:
    """The most top-down of the most confident grasps that the arm can reach."""
    plans: list[_Plan] = []
    for grasp in propose_grasps(points, others)[:TRIED]:
        free = (plan for plan in _plans(start, grasp) if not obstacles.strikes(plan.path))
        plans.extend(islice(free, 1))
        if len(plans) == MOST_CONFIDENT:
            break
    return min(plans, key=lambda plan: plan.grasp.tilt, default=None)


def _plans(start: np.ndarray, grasp: Grasp) -> Iterator[_Plan]:
    """The paths to a grasp, with the fingers on the closer side first; none out of reach."""
    home, sides = np.array(HOME), []
    for pose in (grasp.pose, turned_over(grasp.pose)):
        for ready in islice(kinematics().reach(_pre_grasp(pose), home), 1):
            sides.append((float(np.abs(ready - home).max()), pose, ready))
    for _, pose, ready in sorted(sides, key=lambda side: side[0]):
        approach = line_path(ready, pose)
        lift = None if approach is None else line_path(approach[-1], *_lifted(pose))
        if approach is not None and lift is not None:
            before = np.concatenate([joint_path(start, home), joint_path(home, ready)])
            yield _Plan(Grasp(pose, grasp.confidence), before, approach, lift)


def _pre_grasp(pose: np.ndarray) -> np.ndarray:
    """The hand's pose before it approaches, (4, 4)."""
    before = pose.copy()
    before[:3, 3] -= PRE_GRASP * pose[:3, 2]
    return before


def _lifted(pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The hand's poses straight above, and where a pick ends; it does not turn on the way."""
    above, carried = pose.copy(), pose.copy()
    above[2, 3] += LIFT
    distance = np.linalg.norm(pose[:2, 3])
    carried[:2, 3] *= CARRY[0] / distance
    carried[2, 3] = CARRY[1]
    return above, carried


def _execute(arm: Arm, plan: _Plan) -> Result:
    arm.open_fingers()
    if not arm.follow(plan.before) or not arm.follow(plan.approach):
        arm.follow(joint_path(arm.target, plan.before[-1]))  # back out as it came
        return Result.TIMED_OUT
    arm.close_fingers()
    if arm.grip < EMPTY:
        arm.open_fingers()
        arm.follow(plan.approach[::-1])
        return Result.MISSED
    if not arm.follow(plan.lift):
        return Result.TIMED_OUT
    return Result.DONE if arm.grip > EMPTY else Result.DROPPED

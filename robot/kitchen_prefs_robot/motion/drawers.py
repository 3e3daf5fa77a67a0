"""Open and close a drawer by its handle."""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs_robot.motion.kinematics import hand_pose, kinematics, turned_over
from kitchen_prefs_robot.motion.moves import Arm, OnFrame, joint_path, line_path
from kitchen_prefs_robot.motion.obstacles import Furniture, Obstacles
from kitchen_prefs_robot.motion.outcomes import Outcome, Result
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.arm import HOME
from kitchen_prefs_robot.scene.layout import (
    CABINET_ROTATION,
    DRAWER_TRAVEL,
    HANDLE_RADIUS,
    handle_position,
)

# The hand's tilt from straight down, where a drawer is closed and where it is open: it turns about
# the round bar as it pulls, because a tilted hand would have to go behind the arm's own base.
TILTS = np.deg2rad([40.0, 30.0])
HALF_OPEN = 128.0  # the gripper's control, 43 mm: opened wide, a finger would push at the front
PRE_GRASP = 0.06  # m back along the approach
LETTING_GO = 0.05  # m back until the fingers are off the handle
RETREAT_DISTANCE = 0.42  # m from the base's axis
RETREAT_HEIGHT = 0.46  # m: above both handles, where a sweep to the side moves no open drawer
OPENED = 0.24  # m: what counts as open
SHUT = 0.006  # m: what counts as closed
HELD = (0.6 * 2 * HANDLE_RADIUS, 1.8 * 2 * HANDLE_RADIUS)  # m between fingers that hold a handle


@dataclass(frozen=True)
class _Plan:
    """The joints' paths, (N, 7) each: before the handle, to it, with it, and away from it."""

    before: np.ndarray
    approach: np.ndarray
    slide: np.ndarray
    retreat: np.ndarray

    @property
    def length(self) -> int:
        """In commands."""
        return sum(map(len, (self.before, self.approach, self.slide, self.retreat)))

    def strikes(self, obstacles: Obstacles) -> bool:
        """Whether the arm would strike something on its way."""
        return obstacles.strikes(self.before) or any(
            obstacles.strikes(path, but_drawers=True)
            for path in (self.approach, self.slide, self.retreat)
        )


def open_drawer(
    world: World,
    drawer: str,
    furniture: Furniture | None = None,
    on_frame: OnFrame | None = None,
) -> Outcome:
    """Pull a drawer open.

    Args:
        world: In which the arm moves; its hand is empty.
        drawer: "upper" or "lower". One that is open already stays so, and nothing moves.
        furniture: What is known of drawers and stands; by default all, as it truly is.
        on_frame: Called with the world 50 times a simulated second.

    Returns:
        How it ended; the arm is at home.
    """
    known = furniture or Furniture.true(world)
    if known.openings[drawer] > OPENED:
        return Outcome(Result.DONE, 0.0)
    return _slide(Arm(world, on_frame), drawer, known, DRAWER_TRAVEL)


def close_drawer(
    world: World,
    drawer: str,
    furniture: Furniture | None = None,
    on_frame: OnFrame | None = None,
) -> Outcome:
    """Push a drawer shut; as `open_drawer`."""
    known = furniture or Furniture.true(world)
    if known.openings[drawer] < SHUT:
        return Outcome(Result.DONE, 0.0)
    return _slide(Arm(world, on_frame), drawer, known, 0.0)


def _slide(arm: Arm, drawer: str, known: Furniture, goal: float) -> Outcome:
    started = arm.world.data.time
    at_handle, moved = (
        _at_handle(drawer, max(known.openings[drawer], 0.0)),
        _at_handle(drawer, goal),
    )
    plan = _plan(arm.target, at_handle, moved, Obstacles(arm.world, known))
    if plan is None:
        return Outcome(Result.UNREACHABLE, 0.0)
    result = _execute(arm, plan)
    arm.go_home()
    return Outcome(result, arm.world.data.time - started)


def _plan(
    start: np.ndarray, at_handle: np.ndarray, moved: np.ndarray, obstacles: Obstacles
) -> _Plan | None:
    """The shortest plan of those found, or None."""
    home, plans = np.array(HOME), []
    for turn in (np.copy, turned_over):
        before, there, back = turn(_back(at_handle, PRE_GRASP)), turn(at_handle), turn(moved)
        for ready in kinematics().reach(before, home):
            approach = line_path(ready, there)
            slide = None if approach is None else line_path(approach[-1], back)
            retreat = None if slide is None else line_path(slide[-1], *_away(back))
            if approach is not None and slide is not None and retreat is not None:
                to_ready = np.concatenate([joint_path(start, home), joint_path(home, ready)])
                plans.append(_Plan(to_ready, approach, slide, retreat))
    plans.sort(key=lambda plan: plan.length)
    return next((plan for plan in plans if not plan.strikes(obstacles)), None)


def _at_handle(drawer: str, opening: float) -> np.ndarray:
    """The hand's pose, (4, 4), with a finger above the handle and one below it."""
    tilt = np.interp(opening, (0.0, DRAWER_TRAVEL), TILTS)
    approach = CABINET_ROTATION.apply((-np.sin(tilt), 0.0, -np.cos(tilt)))
    bar = CABINET_ROTATION.apply((0.0, 1.0, 0.0))
    return hand_pose(handle_position(drawer, opening), approach, np.cross(approach, bar))


def _back(pose: np.ndarray, distance: float) -> np.ndarray:
    moved = pose.copy()
    moved[:3, 3] -= distance * pose[:3, 2]
    return moved


def _away(pose: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Off the handle, and up."""
    off = _back(pose, LETTING_GO)
    above = _back(pose, LETTING_GO)
    above[:2, 3] *= RETREAT_DISTANCE / np.linalg.norm(above[:2, 3])
    above[2, 3] = RETREAT_HEIGHT
    return off, above


def _execute(arm: Arm, plan: _Plan) -> Result:
    arm.open_fingers(HALF_OPEN)
    if not arm.follow(plan.before) or not arm.follow(plan.approach):
        arm.follow(joint_path(arm.target, plan.before[-1]))
        return Result.TIMED_OUT
    arm.close_fingers()
    if not _holds(arm):
        arm.open_fingers(HALF_OPEN)
        arm.follow(plan.approach[::-1])
        return Result.MISSED
    if arm.follow(plan.slide):
        held = _holds(arm)
        arm.open_fingers(HALF_OPEN)
        arm.follow(plan.retreat)
        return Result.DONE if held else Result.JAMMED
    arm.follow(joint_path(arm.target, arm.joints))  # it has stopped on its way: let go there
    arm.open_fingers(HALF_OPEN)
    path = line_path(arm.target, *_away(kinematics().pose(arm.target)))
    if path is not None:
        arm.follow(path)
    return Result.JAMMED


def _holds(arm: Arm) -> bool:
    """Whether the fingers are as far apart as the handle is thick."""
    return HELD[0] < arm.grip < HELD[1]

"""Drop what the hand holds into an open drawer, at one place and level as it was picked."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs_robot.motion.drawers import OPENED
from kitchen_prefs_robot.motion.kinematics import kinematics
from kitchen_prefs_robot.motion.moves import Arm, OnFrame, joint_path, line_path
from kitchen_prefs_robot.motion.obstacles import Furniture, Obstacles
from kitchen_prefs_robot.motion.outcomes import Outcome, Result
from kitchen_prefs_robot.motion.picking import EMPTY, PickOutcome
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.layout import (
    CABINET_ROTATION,
    DRAWER_FLOOR,
    FRONT_HEIGHT,
    from_cabinet,
)

OUT = 0.15  # m from the cabinet's front to where dishes drop: the middle of what is open
PLACES = 2
ASIDE = 0.085  # m to the right and to the left of a drawer's middle, by turns
HOVER = FRONT_HEIGHT + 0.015  # m above a drawer's floor, at which a dish passes over its front
# m above the floor where the hand lets go, the lowest first that leaves the hand room: a plate is
# held so flat that the drawer's walls are in the way.
RELEASES = (0.03, 0.08, 0.12, HOVER)
ON_ANOTHER = 0.10  # m: at least this high where a dish lies already
# Where the hand may be, seen from the dish: radians from the cabinet's x axis towards the middle.
SIDES = np.deg2rad([90.0, 60.0, 120.0, 30.0, 0.0])


@dataclass(frozen=True)
class _Plan:
    """The joints' paths, (N, 7) each: over the drawer, down into it, and up again."""

    over: np.ndarray
    down: np.ndarray
    up: np.ndarray

    @property
    def path(self) -> np.ndarray:
        """All of it."""
        return np.concatenate([self.over, self.down, self.up])


def drop(
    world: World,
    drawer: str,
    pick: PickOutcome,
    already: int = 0,
    furniture: Furniture | None = None,
    on_frame: OnFrame | None = None,
) -> Outcome:
    """Drop what a pick has grasped.

    Args:
        world: In which the arm holds something.
        drawer: "upper" or "lower", which is open.
        pick: The outcome of the pick.
        already: How many dishes lie in that drawer: they are dropped to the right and to the left
            by turns.
        furniture: What is known of drawers and stands; by default all, as it truly is.
        on_frame: Called with the world 50 times a simulated second.

    Returns:
        How it ended. The arm is at home; where no path was found, or the drawer is not open, it
        has not moved and still holds the dish (`put_back` puts it down).
    """
    arm, started = Arm(world, on_frame), world.data.time
    known = furniture or Furniture.true(world)
    if known.openings[drawer] <= OPENED:
        return Outcome(Result.NOT_OPEN, 0.0)
    plan = _plan(arm.target, drawer, pick.held, already, Obstacles(world, known))
    if plan is None:
        return Outcome(Result.UNREACHABLE, 0.0)
    if not arm.follow(plan.over):
        arm.open_fingers()
        arm.go_home()
        return Outcome(Result.TIMED_OUT, world.data.time - started)
    arm.follow(plan.down)  # where it does not arrive, the dish rests on another one
    held = arm.grip > EMPTY
    arm.open_fingers()
    arm.follow(plan.up)
    arm.go_home()
    return Outcome(Result.DONE if held else Result.DROPPED, world.data.time - started)


def _plan(
    start: np.ndarray, drawer: str, held: np.ndarray, already: int, obstacles: Obstacles
) -> _Plan | None:
    """The plan that lets go the lowest, and that moves the joints least of those."""
    floor = np.array([OUT, ASIDE * (-1) ** (already + 1), DRAWER_FLOOR[drawer]])
    for release in RELEASES:
        if already < PLACES or release > ON_ANOTHER:
            plans = _plans(start, held, floor, release, (-1) ** already)
            for plan in sorted(plans, key=lambda plan: len(plan.over)):
                if not obstacles.strikes(plan.path, held):
                    return plan
    return None


def _plans(
    start: np.ndarray, held: np.ndarray, floor: np.ndarray, release: float, turn: int
) -> Iterator[_Plan]:
    """Plans with the hand on any side of the dish that the arm can reach."""
    hand = kinematics().pose(start)
    for side in SIDES * turn:
        over, inside = (_hand_over(hand, held, floor, side, up) for up in (HOVER, release))
        for joints in islice(kinematics().reach(over, start), 2):
            down = line_path(joints, inside)
            up = None if down is None else line_path(down[-1], over)
            if down is not None and up is not None:
                yield _Plan(joint_path(start, joints), down, up)


def _hand_over(
    hand: np.ndarray, held: np.ndarray, floor: np.ndarray, side: float, above: float
) -> np.ndarray:
    """The hand's pose, (4, 4), with the dish level over its place in the drawer.

    Args:
        hand: Its pose now, (4, 4).
        held: Points of the dish in the hand's frame, (K, 3) m.
        floor: Its place on the drawer's floor, (3,) m in the cabinet's frame.
        side: Where the hand is, seen from the dish, radians from the cabinet's x axis.
        above: How high the dish is above its place, m.
    """
    level = held @ hand[:3, :3].T  # from the hand to the dish, as it hangs now
    low, high = level.min(axis=0), level.max(axis=0)
    middle = np.array([*(low + high)[:2] / 2, low[2]])
    out = CABINET_ROTATION.apply((1.0, 0.0, 0.0))
    wanted = np.arctan2(out[1], out[0]) + side
    turn = Rotation.from_euler("z", wanted - np.arctan2(-middle[1], -middle[0]))
    pose = np.eye(4)
    pose[:3, :3] = turn.as_matrix() @ hand[:3, :3]
    pose[:3, 3] = from_cabinet(floor + np.array([0.0, 0.0, above])) - turn.apply(middle)
    return pose

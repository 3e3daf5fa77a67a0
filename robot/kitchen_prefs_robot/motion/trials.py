"""How often single motions succeed: dishes are picked, drawers are moved."""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace

import mujoco
import numpy as np

from kitchen_prefs_robot.motion.drawers import OPENED, close_drawer, open_drawer
from kitchen_prefs_robot.motion.obstacles import Furniture
from kitchen_prefs_robot.motion.picking import pick
from kitchen_prefs_robot.motion.seen_points import Points
from kitchen_prefs_robot.scene import PAPER_DISHES, World, sample_scene

STATE = mujoco.mjtState.mjSTATE_INTEGRATION  # all that physics goes on from
LIFTED = 0.10  # m: a dish that stands this much higher than before has been picked
CLOSED = 0.01  # m: what counts as closed

PointsOf = Callable[[World, np.random.Generator], list[Points]]


def pick_each(seed: int, points_of: PointsOf, pose_error: float) -> dict[str, tuple[bool, str]]:
    """Pick each of the paper's four dishes from one scene, with all of them in place.

    Args:
        seed: Of the scene.
        points_of: Gives the points of each dish and of all else.
        pose_error: m by which a dish's points are moved to the side, standard deviation.

    Returns:
        By category whether the dish truly hangs in the hand at the end, and what the arm felt.
    """
    rng = np.random.default_rng(seed)
    world = World(sample_scene(seed, PAPER_DISHES))
    start, results = _state(world), {}
    for number, (points, others) in enumerate(points_of(world, rng)):
        mujoco.mj_setState(world.model, world.data, start, STATE)
        mujoco.mj_forward(world.model, world.data)
        before = world.dish_pose(number)[0][2]
        error = np.array([*rng.normal(0.0, pose_error, 2), 0.0])
        outcome = pick(world, points + error, others)
        lifted = bool(world.dish_pose(number)[0][2] > before + LIFTED)
        results[PAPER_DISHES[number]] = (lifted, outcome.result.value)
    return results


def _state(world: World) -> np.ndarray:
    state = np.empty(mujoco.mj_stateSize(world.model, STATE))
    mujoco.mj_getState(world.model, world.data, state, STATE)
    return state


def move_drawers(drawer: str, times: int, opening_error: float) -> Counter[str]:
    """Open and close a drawer.

    Args:
        drawer: "upper" or "lower".
        times: Each in another scene.
        opening_error: m by which its opening is mistaken each time, standard deviation.

    Returns:
        How often it was truly "opened" and "closed".
    """
    rng, counts = np.random.default_rng(0), Counter(opened=0, closed=0)
    for seed in range(times):
        world = World(sample_scene(seed))
        open_drawer(world, drawer, _mistaken(world, drawer, rng.normal(0.0, opening_error)))
        counts["opened"] += world.drawer_opening(drawer) > OPENED
        close_drawer(world, drawer, _mistaken(world, drawer, rng.normal(0.0, opening_error)))
        counts["closed"] += world.drawer_opening(drawer) < CLOSED
    return counts


def _mistaken(world: World, drawer: str, error: float) -> Furniture:
    """The furniture with the opening of one drawer mistaken by `error` m."""
    true = Furniture.true(world)
    return replace(true, openings={**true.openings, drawer: true.openings[drawer] + error})

"""How often single motions succeed: one dish is picked from each scene, drawers are moved."""

from collections import Counter
from collections.abc import Callable, Iterator

import numpy as np

from kitchen_prefs_robot.motion.drawers import OPENED, close_drawer, open_drawer
from kitchen_prefs_robot.motion.picking import pick
from kitchen_prefs_robot.scene import PAPER_DISHES, World, sample_scene

LIFTED = 0.10  # m: a dish that stands this much higher than before has been picked
CLOSED = 0.01  # m: what counts as closed

Points = Callable[[World, int, np.random.Generator], tuple[np.ndarray, np.ndarray]]


def pick_once(seed: int, number: int, points_of: Points, pose_error: float) -> tuple[bool, str]:
    """Pick one dish of a scene of the paper's four.

    Args:
        seed: Of the scene.
        number: The dish's place in the scene's list.
        points_of: Gives the points of the dish and of all else.
        pose_error: m by which the dish's points are moved to the side, standard deviation.

    Returns:
        Whether the dish truly hangs in the hand, and what the arm felt.
    """
    rng = np.random.default_rng([seed, number])
    world = World(sample_scene(seed, PAPER_DISHES))
    points, others = points_of(world, number, rng)
    points = points + np.array([*rng.normal(0.0, pose_error, 2), 0.0])
    before = world.dish_pose(number)[0][2]
    outcome = pick(world, points, others)
    return bool(world.dish_pose(number)[0][2] > before + LIFTED), outcome.result.value


def pick_often(
    number: int, picks: int, points_of: Points, pose_error: float
) -> Iterator[tuple[bool, str]]:
    """Pick a dish from scenes 0, 1, ... as `pick_once`."""
    for seed in range(picks):
        yield pick_once(seed, number, points_of, pose_error)


def move_drawers(drawer: str, times: int) -> Counter[str]:
    """Open and close a drawer; how often it was truly opened and closed."""
    counts: Counter[str] = Counter(opened=0, closed=0)
    for seed in range(times):
        world = World(sample_scene(seed))
        open_drawer(world, drawer)
        counts["opened"] += world.drawer_opening(drawer) > OPENED
        close_drawer(world, drawer)
        counts["closed"] += world.drawer_opening(drawer) < CLOSED
    return counts

"""How well perception does on random scenes: what it takes dishes for, and how far it errs."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linear_sum_assignment

from kitchen_prefs_robot.perception.calibration import pose_error
from kitchen_prefs_robot.perception.cameras import Cameras, calibrate
from kitchen_prefs_robot.perception.categories import KnownDish
from kitchen_prefs_robot.perception.detection import Detection, Sight, perceive
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.scene.layout import DRAWER_TRAVEL, DRAWERS
from kitchen_prefs_robot.scene.tableware import Colours
from kitchen_prefs_robot.scene.views import PICTURE_SIZE

SAME_DISH = 0.08  # m between a cluster and the dish that it stands for, at most
OPENING = 7  # sets the random numbers of the opening apart from the others of a seed
UNKNOWN, MISSED = "unknown", "missed"


@dataclass(frozen=True)
class FoundDish:
    """A dish and what was made of it.

    Attributes:
        category: The true one.
        seen_as: A category, "unknown" or "missed".
        mean_error: From the true middle to the mean of the cluster's points, (3,) m; NaN if missed.
        middle_error: The same to the middle of the cluster's box.
    """

    category: str
    seen_as: str
    mean_error: np.ndarray
    middle_error: np.ndarray


@dataclass(frozen=True)
class Trial:
    """One scene.

    Attributes:
        dishes: All that stand on the table.
        extra: Clusters that are no dish or the second of one dish.
        touching: Clusters too large to be one dish.
        camera_errors: Distance (m) and angle (radians) of each camera's pose, (3, 2).
        opening_error: Of one drawer, opened somewhere between closed and open, m.
    """

    dishes: tuple[FoundDish, ...]
    extra: int
    touching: int
    camera_errors: np.ndarray
    opening_error: float

    @property
    def is_right(self) -> bool:
        """Whether each dish was found and taken for what it is, and nothing else was."""
        return not self.extra and all(dish.seen_as == dish.category for dish in self.dishes)


def run_trial(
    seed: int,
    known: Sequence[KnownDish],
    colours: Colours = "distinct",
    lamp: float = 0.0,
    depth_noise: float = 1.0,
) -> Trial:
    """Look once at a random scene, with cameras calibrated by what they see of the tags.

    Args:
        seed: Of the scene, of the depth's noise and of the drawer's opening.
        known: The dishes of the scene, as they look under the usual lamp.
        colours: "distinct" or "alike".
        lamp: How much the light changes at most, as a share of its brightness.
        depth_noise: Multiplies the depth's error.
    """
    dishes = tuple(dish.category for dish in known)
    world = World(sample_scene(seed, dishes, colours, lamp))
    rng = np.random.default_rng([seed, OPENING])
    drawer, opening = str(rng.choice(DRAWERS)), float(rng.uniform(0.0, DRAWER_TRAVEL))
    world.set_drawer(drawer, opening)
    poses = calibrate(world)
    with Cameras(world, poses, *PICTURE_SIZE, depth_noise, seed) as cameras:
        sight = perceive(cameras.cloud(cameras.take()), known)
    errors = [pose_error(poses[camera], _true_pose(world, camera)) for camera in world.cameras]
    found, extra = _compare(world, sight)
    opening_error = sight.openings[drawer] - opening
    return Trial(found, extra, len(sight.touching), np.array(errors), opening_error)


def confusion(trials: Iterable[Trial]) -> Counter[tuple[str, str]]:
    """How often a category, the first of the pair, was seen as another, the second."""
    return Counter((dish.category, dish.seen_as) for trial in trials for dish in trial.dishes)


def _compare(world: World, sight: Sight) -> tuple[tuple[FoundDish, ...], int]:
    """Pair dishes with clusters; also the number of clusters without a dish."""
    true = np.array([world.dish_pose(i)[0] for i in range(len(world.scene.dishes))])  # (D, 3)
    middles = np.array([found.box.middle for found in sight.dishes]).reshape(-1, 3)  # (F, 3)
    distances = np.linalg.norm(true[:, None] - middles, axis=2)  # (D, F)
    pairs = {int(i): int(j) for i, j in zip(*linear_sum_assignment(distances), strict=True)}
    found = []
    for number, dish in enumerate(world.scene.dishes):
        cluster = pairs.get(number)
        if cluster is not None and distances[number, cluster] < SAME_DISH:
            found.append(_found(dish.category, true[number], sight.dishes[cluster]))
        else:
            found.append(FoundDish(dish.category, MISSED, np.full(3, np.nan), np.full(3, np.nan)))
    matched = sum(dish.seen_as != MISSED for dish in found)
    return tuple(found), len(sight.dishes) - matched


def _found(category: str, position: np.ndarray, seen: Detection) -> FoundDish:
    return FoundDish(
        category, seen.category or UNKNOWN, seen.mean - position, seen.box.middle - position
    )


def _true_pose(world: World, camera: str) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3], pose[:3, :3] = world.camera_pose(camera)
    return pose

"""The set of dishes that the robot knows: measured once, under the usual lamp, before any task."""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from kitchen_prefs_robot.perception.cameras import Cameras, laboratory_poses
from kitchen_prefs_robot.perception.categories import KnownDish
from kitchen_prefs_robot.perception.cloud import Cloud
from kitchen_prefs_robot.perception.clusters import find_clusters
from kitchen_prefs_robot.perception.detection import median_colour
from kitchen_prefs_robot.perception.regions import cut_regions
from kitchen_prefs_robot.scene import PAPER_DISHES, World, sample_scene
from kitchen_prefs_robot.scene.tableware import Colours, real_extents
from kitchen_prefs_robot.scene.views import PICTURE_SIZE

SEED = 1_000_000  # of the scenes that show them; no experiment uses it
TOGETHER = 4  # dishes on the table at once


@lru_cache
def known_dishes(
    categories: tuple[str, ...] = PAPER_DISHES, colours: Colours = "distinct"
) -> tuple[KnownDish, ...]:
    """Look at dishes that stand where somebody who knows them has put them.

    Args:
        categories: Of the dishes.
        colours: Of the scenes to come, "distinct" or "alike".

    Returns:
        One known dish a category.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
        ValueError: If a category or the colours are unknown.
    """
    once = tuple(dict.fromkeys(categories))
    groups = [once[start : start + TOGETHER] for start in range(0, len(once), TOGETHER)]
    return tuple(dish for group in groups for dish in _look_at(group, colours))


def _look_at(categories: tuple[str, ...], colours: Colours) -> Iterator[KnownDish]:
    world = World(sample_scene(SEED, categories, colours))
    with Cameras(world, laboratory_poses(), *PICTURE_SIZE) as cameras:
        cloud = cameras.cloud(cameras.take())
    counter = cut_regions(cloud, np.random.default_rng(0)).clouds["counter"]
    clusters = find_clusters(counter, largest=np.inf)
    for category, dish in zip(categories, world.scene.dishes, strict=True):
        cluster = min(clusters, key=lambda found: _distance(found, dish.position))
        red, green, blue = (float(channel) for channel in median_colour(cluster))
        length, width, height = (float(extent) for extent in real_extents(category))
        yield KnownDish(category, (red, green, blue), (length, width, height))


def _distance(cluster: Cloud, position: tuple[float, float, float]) -> float:
    return float(np.linalg.norm(cluster.points.mean(axis=0) - position))

"""Points of one dish and of all else, exact or as cameras see them, for trials of single picks.

Which points belong to the dish is known here; to find that out is perception's work.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.rendering.tableware import surface
from kitchen_prefs_robot.scene import Pictures, World
from kitchen_prefs_robot.scene.layout import COUNTER_X, COUNTER_Y
from kitchen_prefs_robot.scene.tableware import SCALES, SIDES, real_extents

COUNT = 1500  # points on the whole surface of a dish
WIDTH, HEIGHT = 320, 240  # pixels of the pictures: one is 4 mm wide on the table
VOXEL = 0.004  # m: one point is kept in each cube of that side
NOISE = 0.0025  # m, standard deviation of each coordinate of each point
OFFSET = 0.004  # m, standard deviation of each coordinate of all points at once
SLACK = 0.006  # m round a dish's box within which points are its own
# The part of the table that is looked at: lowest and highest corner, m.
REGION = np.array(
    [(COUNTER_X[0] - 0.14, COUNTER_Y[0] - 0.14, 0.008), (COUNTER_X[1] + 0.14, 0.22, 0.36)]
)


def exact_points(
    world: World, number: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Points on the whole surface of a dish, where it truly is, and of all others.

    Args:
        world: As it stands.
        number: The dish's place in the scene's list.
        rng: Draws the points.

    Returns:
        (N, 3) and (M, 3) m in the base's frame.
    """
    clouds = [_surface_points(world, other, rng) for other in range(len(world.scene.dishes))]
    own = clouds.pop(number)
    return own, np.concatenate([np.empty((0, 3)), *clouds])


def seen_points(
    world: World, number: int, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """What the three cameras see of a dish and of all else, with noise; as `exact_points`.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
    """
    with Pictures(world, WIDTH, HEIGHT) as pictures:
        cloud = np.concatenate([_camera_points(world, pictures, name) for name in world.cameras])
    cloud = cloud[((cloud > REGION[0]) & (cloud < REGION[1])).all(axis=1)]
    _, kept = np.unique(np.floor(cloud / VOXEL), axis=0, return_index=True)
    cloud = cloud[kept]
    position, quaternion = world.dish_pose(number)
    local = Rotation.from_quat(quaternion, scalar_first=True).inv().apply(cloud - position)
    half = real_extents(world.scene.dishes[number].category) / 2 + SLACK
    own = (np.abs(local) < half).all(axis=1)
    cloud = cloud + rng.normal(0.0, NOISE, cloud.shape) + rng.normal(0.0, OFFSET, 3)
    return cloud[own], cloud[~own]


def _surface_points(world: World, number: int, rng: np.random.Generator) -> np.ndarray:
    """Points spread evenly over a dish's surface, (COUNT, 3)."""
    category = world.scene.dishes[number].category
    shape = surface(category, SIDES)
    triangles = SCALES[category] * shape.vertices[shape.faces]  # (F, 3, 3)
    edges = triangles[:, 1:] - triangles[:, :1]
    areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    chosen = triangles[rng.choice(len(areas), COUNT, p=areas / areas.sum())]
    points = (chosen * rng.dirichlet((1.0, 1.0, 1.0), COUNT)[:, :, None]).sum(axis=1)
    position, quaternion = world.dish_pose(number)
    return Rotation.from_quat(quaternion, scalar_first=True).apply(points) + position


def _camera_points(world: World, pictures: Pictures, camera: str) -> np.ndarray:
    """Where a camera's rays end, (H * W, 3) m in the base's frame."""
    depth = pictures.depth(camera)
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    pixels = np.stack([columns, rows, np.ones_like(rows)], axis=-1).reshape(-1, 3)
    rays = pixels @ np.linalg.inv(world.intrinsics(WIDTH, HEIGHT)).T
    position, rotation = world.camera_pose(camera)
    return (depth.reshape(-1, 1) * rays) @ rotation.T + position

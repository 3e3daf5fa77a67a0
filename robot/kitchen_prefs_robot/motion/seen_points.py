"""Points of a dish and of all else, exact or as cameras see them, for trials of single picks.

Which points belong to the dish is known here; to find that out is perception's work.
"""

import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.rendering.tableware import surface
from kitchen_prefs_robot.perception.cloud import Frame, deproject
from kitchen_prefs_robot.scene import Pictures, World
from kitchen_prefs_robot.scene.layout import COUNTER_X, COUNTER_Y
from kitchen_prefs_robot.scene.tableware import SCALES, SIDES, real_extents
from kitchen_prefs_robot.scene.views import PICTURE_SIZE

Points = tuple[np.ndarray, np.ndarray]  # of a dish and of all else

COUNT = 1500  # points on the whole surface of a dish
VOXEL = 0.004  # m: one point is kept in each cube of that side
NOISE = 0.0025  # m, standard deviation of each coordinate of each point
OFFSET = 0.004  # m, standard deviation of each coordinate of all points at once
SLACK = 0.006  # m round a dish's box within which points are its own
# The part of the table that is looked at: lowest and highest corner, m.
REGION = np.array(
    [(COUNTER_X[0] - 0.14, COUNTER_Y[0] - 0.14, 0.008), (COUNTER_X[1] + 0.14, 0.22, 0.36)]
)


def exact_points(world: World, rng: np.random.Generator) -> list[Points]:
    """Points on the whole surface of each dish, where it truly is.

    Args:
        world: As it stands.
        rng: Draws the points.

    Returns:
        For each dish its points, (N, 3) m in the base's frame, and those of all others, (M, 3).
    """
    clouds = [_surface_points(world, number, rng) for number in range(len(world.scene.dishes))]
    return [
        (own, np.concatenate([np.empty((0, 3)), *clouds[:number], *clouds[number + 1 :]]))
        for number, own in enumerate(clouds)
    ]


def seen_points(world: World, rng: np.random.Generator) -> list[Points]:
    """What the three cameras see of each dish and of all else, with noise; as `exact_points`.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
    """
    with Pictures(world, *PICTURE_SIZE) as pictures:
        cloud = np.concatenate([_camera_points(world, pictures, name) for name in world.cameras])
    cloud = cloud[((cloud > REGION[0]) & (cloud < REGION[1])).all(axis=1)]
    _, kept = np.unique(np.floor(cloud / VOXEL), axis=0, return_index=True)
    cloud = cloud[kept]
    noisy = cloud + rng.normal(0.0, NOISE, cloud.shape) + rng.normal(0.0, OFFSET, 3)
    owns = [_within(world, number, cloud) for number in range(len(world.scene.dishes))]
    return [(noisy[own], noisy[~own]) for own in owns]


def _within(world: World, number: int, cloud: np.ndarray) -> np.ndarray:
    """Which points, (N, 3), lie in the box of a dish where it truly is, (N,) bool."""
    position, quaternion = world.dish_pose(number)
    local = Rotation.from_quat(quaternion, scalar_first=True).inv().apply(cloud - position)
    half = real_extents(world.scene.dishes[number].category) / 2 + SLACK
    return (np.abs(local) < half).all(axis=1)


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
    frame = Frame(*pictures.colour_and_depth(camera), world.intrinsics(*PICTURE_SIZE))
    position, rotation = world.camera_pose(camera)
    return deproject(frame).points @ rotation.T + position

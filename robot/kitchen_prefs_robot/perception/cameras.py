"""The three RGB-D cameras of a world, calibrated by the tags, with the depth of real ones."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Self

import numpy as np

from kitchen_prefs_robot.perception.calibration import camera_to_base, find_tags
from kitchen_prefs_robot.perception.cloud import Cloud, Frame, deproject, joined, moved
from kitchen_prefs_robot.perception.depth_filter import smoothed
from kitchen_prefs_robot.perception.depth_noise import with_noise
from kitchen_prefs_robot.scene import TAGS, Pictures, World, sample_scene, tag_corners

CALIBRATION_SIZE = (1280, 960)  # pixels; the paper's cameras have colour pictures of 1920 x 1080
FARTHEST = 2.2  # m: the table ends there, and depth is noisy


@lru_cache
def laboratory_poses() -> dict[str, np.ndarray]:
    """The cameras' poses as `calibrate` finds them once, before any dish stands on the table."""
    return calibrate(World(sample_scene(0, dishes=())))


def displaced_poses(error: float, seed: int) -> dict[str, np.ndarray]:
    """The laboratory's poses, each camera's position off by a random error.

    Args:
        error: Standard deviation of each coordinate, m.
        seed: Draws the errors.
    """
    rng = np.random.default_rng([seed, len("cameras")])
    poses = {name: pose.copy() for name, pose in laboratory_poses().items()}
    for pose in poses.values():
        pose[:3, 3] += error * rng.standard_normal(3)
    return poses


def calibrate(world: World) -> dict[str, np.ndarray]:
    """Find where each camera stands, from the tags on the table alone.

    Returns:
        For each camera the transform from its frame to the base's, (4, 4).

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
        ValueError: If a camera sees no tag.
    """
    known = {number: tag_corners(number) for number in TAGS}
    intrinsics = world.intrinsics(*CALIBRATION_SIZE)
    with Pictures(world, *CALIBRATION_SIZE) as pictures:
        return {
            camera: camera_to_base(find_tags(pictures.colour(camera)), known, intrinsics)
            for camera in world.cameras
        }


class Cameras:
    """Takes pictures with depth; a context manager that releases OpenGL.

    Args:
        world: What is seen, in its state at the moment of each picture.
        poses: For each camera the transform from its frame to the base's, (4, 4).
        width: Of the pictures, in pixels.
        height: Of the pictures, in pixels.
        depth_noise: Multiplies the error of the measured depth, see `depth_noise`.
        seed: Draws the depth's errors.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
    """

    def __init__(
        self,
        world: World,
        poses: Mapping[str, np.ndarray],
        width: int,
        height: int,
        depth_noise: float = 1.0,
        seed: int = 0,
    ) -> None:
        self._world, self._poses = world, poses
        self._intrinsics = world.intrinsics(width, height)
        self._pictures = Pictures(world, width, height)
        self._depth_noise = depth_noise
        self._rng = np.random.default_rng(seed)

    def __enter__(self) -> Self:
        self._pictures.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._pictures.__exit__(*error)

    def take(self) -> dict[str, Frame]:
        """A picture with depth of each camera."""
        return {camera: self._take(camera) for camera in self._world.cameras}

    def cloud(self, frames: Mapping[str, Frame]) -> Cloud:
        """All that the cameras see, as one cloud in the base's frame."""
        return joined(
            [
                moved(deproject(frame, FARTHEST), self._poses[camera])
                for camera, frame in frames.items()
            ]
        )

    def _take(self, camera: str) -> Frame:
        colour, depth = self._pictures.colour_and_depth(camera)
        measured = with_noise(depth, self._rng, self._depth_noise)
        return Frame(colour, smoothed(measured), self._intrinsics)

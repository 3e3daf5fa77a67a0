"""Where a camera stands, from the fiducial tags that it sees."""

from collections.abc import Mapping

import cv2
import numpy as np
from scipy.spatial.transform import Rotation


def find_tags(picture: np.ndarray) -> dict[int, np.ndarray]:
    """Find the AprilTags of the family 36h11 in a picture.

    Args:
        picture: (H, W, 3) uint8.

    Returns:
        The corners of each tag's black square by its number, (4, 2) pixels: top left, top right,
        bottom right, bottom left, where the middle of the first pixel is (.5, .5).
    """
    options = cv2.aruco.DetectorParameters()
    # Lines fitted to a tag's sides: errors are a quarter of those of the search near corners.
    options.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_APRILTAG
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    grey = cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)
    corners, numbers, _ = cv2.aruco.ArucoDetector(family, options).detectMarkers(grey)
    if numbers is None:
        return {}
    # With this refinement the middle of OpenCV's first pixel is (1, 1).
    return {
        int(number): quad.reshape(4, 2).astype(float) - 0.5
        for number, quad in zip(numbers.ravel(), corners, strict=True)
    }


def camera_to_base(
    seen: Mapping[int, np.ndarray], known: Mapping[int, np.ndarray], intrinsics: np.ndarray
) -> np.ndarray:
    """Where a camera stands, from the corners of known tags, all of which lie on the table.

    Args:
        seen: Corners in the picture by the tag's number, (4, 2) pixels, as from `find_tags`.
        known: The same corners in the base's frame, (4, 3) m.
        intrinsics: The camera's matrix, (3, 3) pixels.

    Returns:
        The transform from the camera's frame (x right, y down, z ahead) to the base's, (4, 4).

    Raises:
        ValueError: If the camera sees none of the known tags.
    """
    numbers = sorted(seen.keys() & known.keys())
    if not numbers:
        raise ValueError(
            "A camera sees no tag of the table; take away what covers the tags, or make its "
            "pictures larger."
        )
    pixels = np.concatenate([seen[number] for number in numbers])  # (4 T, 2)
    corners = np.concatenate([known[number] for number in numbers])  # (4 T, 3)
    _, turn, shift = cv2.solvePnP(corners, pixels, intrinsics, None, flags=cv2.SOLVEPNP_IPPE)
    turn, shift = cv2.solvePnPRefineLM(corners, pixels, intrinsics, None, turn, shift)
    base_to_camera = np.eye(4)
    base_to_camera[:3, :3], base_to_camera[:3, 3] = cv2.Rodrigues(turn)[0], shift.ravel()
    return np.linalg.inv(base_to_camera)


def pose_error(estimated: np.ndarray, true: np.ndarray) -> tuple[float, float]:
    """How far an estimated pose lies from the true one.

    Args:
        estimated: (4, 4).
        true: (4, 4).

    Returns:
        The distance in m and the angle in radians.
    """
    turn = Rotation.from_matrix(estimated[:3, :3].T @ true[:3, :3])
    return float(np.linalg.norm(estimated[:3, 3] - true[:3, 3])), float(turn.magnitude())

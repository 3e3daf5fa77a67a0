import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

pytest.importorskip("fast_simplification", reason="needs the extra `robot`")

from kitchen_prefs_robot.perception.calibration import camera_to_base, find_tags, pose_error

INTRINSICS = np.array([[600.0, 0, 320], [0, 600, 240], [0, 0, 1]])
SQUARE = 0.04 * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)])
KNOWN = {
    number: SQUARE + np.array([x, y, 0.0])
    for number, (x, y) in enumerate([(0.2, -0.3), (0.2, 0.2), (0.7, -0.3), (0.7, 0.2)])
}


@pytest.fixture
def pose():
    """A camera a metre away that looks down at the table."""
    ahead = np.array([0.45, -0.05, 0.0]) - np.array([1.0, -0.6, 0.9])
    right = np.cross(ahead, (0, 0, 1))
    axes = np.stack([right, np.cross(ahead, right), ahead], axis=1)
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = axes / np.linalg.norm(axes, axis=0), (1.0, -0.6, 0.9)
    return pose


def project(points, pose):
    seen = (points - pose[:3, 3]) @ pose[:3, :3] @ INTRINSICS.T
    return seen[:, :2] / seen[:, 2:]


def test_exact_corners_give_the_exact_pose(pose):
    seen = {number: project(corners, pose) for number, corners in KNOWN.items()}
    metres, radians = pose_error(camera_to_base(seen, KNOWN, INTRINSICS), pose)
    assert metres < 1e-5
    assert radians < 1e-5


def test_corners_that_err_by_a_third_of_a_pixel_give_millimetres(pose):
    rng = np.random.default_rng(0)
    errors = []
    for _ in range(20):
        seen = {n: project(c, pose) + 0.3 * rng.standard_normal((4, 2)) for n, c in KNOWN.items()}
        errors.append(pose_error(camera_to_base(seen, KNOWN, INTRINSICS), pose)[0])
    assert 0.0002 < np.median(errors) < 0.006


def test_one_tag_is_enough_and_unknown_tags_are_left_out(pose):
    seen = {2: project(KNOWN[2], pose), 77: np.zeros((4, 2))}
    assert pose_error(camera_to_base(seen, KNOWN, INTRINSICS), pose)[0] < 1e-4


def test_no_tag_is_one_sentence():
    with pytest.raises(ValueError, match="sees no tag"):
        camera_to_base({}, KNOWN, INTRINSICS)


def test_a_drawn_tag_is_found_where_it_was_drawn():
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    picture = np.full((240, 320), 255, np.uint8)
    picture[60:140, 100:180] = cv2.aruco.generateImageMarker(family, 5, 80)
    found = find_tags(np.repeat(picture[..., None], 3, axis=2))
    assert list(found) == [5]
    assert found[5] == pytest.approx(
        np.array([(100, 60), (180, 60), (180, 140), (100, 140)]), abs=0.6
    )


def test_a_picture_without_tags_has_none():
    assert find_tags(np.full((100, 100, 3), 128, np.uint8)) == {}


def test_the_error_of_a_pose_is_a_distance_and_an_angle(pose):
    other = pose.copy()
    other[:3, 3] += (0.0, 0.003, 0.004)
    other[:3, :3] = Rotation.from_rotvec((0, 0, 0.01)).as_matrix() @ other[:3, :3]
    assert pose_error(other, pose) == pytest.approx((0.005, 0.01))

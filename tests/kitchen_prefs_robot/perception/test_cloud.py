import numpy as np
import pytest

pytest.importorskip("fast_simplification", reason="needs the extra `robot`")

from kitchen_prefs_robot.perception.cloud import Cloud, Frame, deproject, moved, thinned, within
from kitchen_prefs_robot.perception.depth_filter import smoothed
from kitchen_prefs_robot.perception.depth_noise import with_noise

INTRINSICS = np.array([[300.0, 0, 160], [0, 300, 120], [0, 0, 1]])


def grey(points):
    return Cloud(np.array(points, dtype=float), np.full((len(points), 3), 0.5))


def test_pixels_become_the_points_that_they_show():
    rng = np.random.default_rng(0)
    rows, columns = rng.integers(240, size=20), rng.integers(320, size=20)
    depth, colour = np.zeros((240, 320)), np.zeros((240, 320, 3), np.uint8)
    depth[rows, columns] = rng.uniform(0.5, 2.0, 20)
    colour[rows, columns] = 255
    cloud = deproject(Frame(colour, depth, INTRINSICS))
    assert len(cloud) == (depth > 0).sum()
    pixels = cloud.points @ INTRINSICS.T
    seen = np.floor(pixels[:, :2] / pixels[:, 2:]).astype(int)
    assert {tuple(pixel) for pixel in seen} == set(zip(columns, rows, strict=True))
    assert (cloud.colours == 1).all()


def test_a_pixel_without_depth_or_too_far_gives_no_point():
    depth = np.array([[0.0, 1.0, 3.0]])
    frame = Frame(np.zeros((1, 3, 3), np.uint8), depth, INTRINSICS)
    assert len(deproject(frame, farthest=2.0)) == 1


def test_a_cloud_moves_by_its_transform():
    transform = np.array([[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1.0]])
    assert moved(grey([[1, 0, 0]]), transform).points[0] == pytest.approx((1, 3, 3))


def test_a_grid_keeps_one_mean_point_a_cube():
    cloud = Cloud(np.array([[0.1, 0, 0], [0.3, 0, 0], [1.5, 0, 0]]), np.eye(3))
    thin = thinned(cloud, 1.0)
    assert thin.points[:, 0] == pytest.approx([0.2, 1.5])
    assert thin.colours[0] == pytest.approx([0.5, 0.5, 0])


def test_a_box_keeps_what_lies_in_it():
    points = np.array([[0, 0, 0], [2, 0, 0], [0.5, 0.5, 0.5]])
    assert within(points, (-1, -1, -1), (1, 1, 1)).tolist() == [True, False, True]


def test_noise_grows_with_the_square_of_the_distance():
    rng = np.random.default_rng(0)
    errors = [with_noise(np.full((200, 200), z), rng).std() for z in (0.5, 1.0, 2.0)]
    assert errors[1] == pytest.approx(0.0038, rel=0.1)
    assert errors[1] / errors[0] == pytest.approx(4, rel=0.1)
    assert errors[2] / errors[1] == pytest.approx(4, rel=0.1)


def test_edges_lose_pixels_and_blend_some():
    depth = np.full((100, 100), 1.0)
    depth[:, 50:] = 2.0
    noisy = with_noise(depth, np.random.default_rng(0))
    edge = noisy[:, 49:51]
    assert (edge == 0).mean() == pytest.approx(0.5, abs=0.12)
    assert ((edge > 1.1) & (edge < 1.9)).mean() == pytest.approx(0.2, abs=0.1)
    assert (noisy[:, :48] > 0).all()


def test_no_noise_leaves_depths_as_they_are():
    depth = np.random.default_rng(0).uniform(0, 2, (20, 20))
    assert (with_noise(depth, np.random.default_rng(0), 0.0) == depth).all()


def test_the_filter_smooths_surfaces_and_keeps_edges_and_gaps():
    rng = np.random.default_rng(0)
    depth = np.full((60, 60), 1.0) + 0.004 * rng.standard_normal((60, 60))
    depth[:, 30:] += 1.0
    depth[10, 10] = 0.0
    filtered = smoothed(depth)
    assert filtered[20:, 5:25].std() < 0.5 * depth[20:, 5:25].std()
    assert filtered[30, 28] < 1.1
    assert filtered[30, 31] > 1.9
    assert filtered[10, 10] == 0
    assert filtered[10, 11] == pytest.approx(1.0, abs=0.02)

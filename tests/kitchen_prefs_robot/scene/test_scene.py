"""The scene: it compiles, dishes lie still, cameras and tags are where they say."""

import numpy as np
import pytest

pytest.importorskip("mink", reason="needs the extra `robot`")

import cv2

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs_robot.scene import PAPER_DISHES, TAGS, Pictures, World, sample_scene, tag_corners
from kitchen_prefs_robot.scene.layout import (
    CABINET_DISTANCE,
    COUNTER_X,
    COUNTER_Y,
    HANDLE_OUT,
    handle_position,
)
from kitchen_prefs_robot.scene.tableware import real_extents


@pytest.fixture(scope="module")
def world():
    return World(sample_scene(0))


def test_a_seed_gives_one_scene():
    assert sample_scene(3) == sample_scene(3)
    assert sample_scene(3) != sample_scene(4)


@pytest.mark.parametrize("seed", range(20))
def test_dishes_stand_apart_on_the_counter(seed):
    scene = sample_scene(seed)
    places = np.array([dish.position[:2] for dish in scene.dishes])
    sizes = [real_extents(dish.category)[:2].max() for dish in scene.dishes]
    assert (places >= (COUNTER_X[0], COUNTER_Y[0])).all()
    assert (places <= (COUNTER_X[1], COUNTER_Y[1])).all()
    for first in range(len(places)):
        for second in range(first):
            gap = np.linalg.norm(places[first] - places[second])
            assert gap > (sizes[first] + sizes[second]) / 2 + 0.045


def test_every_category_rests_where_it_was_put():
    for category in CATEGORIES:
        world = World(sample_scene(1, (category,)))
        before, after = world.scene.dishes[0].position, world.dish_pose(0)[0]
        assert np.linalg.norm(after - before) < 0.003, category
        world.advance(1.0)
        assert np.linalg.norm(world.dish_pose(0)[0] - after) < 0.001, category


def test_a_dish_is_put_where_a_hand_puts_it(world):
    world.set_dish_pose(0, (0.5, 0.3, 0.10), (1.0, 0.0, 0.0, 0.0))
    world.advance(1.0)
    height = real_extents(PAPER_DISHES[0])[2] / 2
    assert world.dish_pose(0)[0] == pytest.approx((0.5, 0.3, height), abs=0.004)


def test_a_drawer_slides(world):
    world.set_drawer("upper", 0.25)
    assert world.drawer_opening("upper") == pytest.approx(0.25)
    assert world.drawer_opening("lower") == pytest.approx(0.0)
    handle = np.linalg.norm(handle_position("upper", 0.25)[:2])
    assert handle == pytest.approx(CABINET_DISTANCE - 0.25 - HANDLE_OUT)
    world.set_drawer("upper", 0.0)


def test_colours_alike_and_the_lamp():
    distinct, alike = sample_scene(0), sample_scene(0, colours="alike", lamp=0.2)
    assert [d.position for d in distinct.dishes] == [d.position for d in alike.dishes]
    assert distinct.lamp == (1.0, 1.0, 1.0)
    assert np.abs(np.array(alike.lamp) - 1.0).max() <= 0.33
    small, big = (np.array(dish.colour) for dish in alike.dishes[:2])
    assert np.abs(small - big).max() < 0.1


@pytest.mark.parametrize(
    ("dishes", "colours", "named"),
    [(("fork",), "distinct", "fork"), (("cup",), "pink", "pink"), (("cup",) * 30, "alike", "30")],
)
def test_what_there_is_not_is_named(dishes, colours, named):
    with pytest.raises(ValueError, match=named):
        sample_scene(0, dishes, colours)


def test_the_cameras_see_the_tags_where_they_are(world):
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    detector = cv2.aruco.ArucoDetector(family)
    intrinsics, seen = world.intrinsics(640, 480), set()
    with Pictures(world, 640, 480) as pictures:
        for camera in world.cameras:
            colour, depth = pictures.colour_and_depth(camera)
            position, rotation = world.camera_pose(camera)
            corners, numbers, _ = detector.detectMarkers(colour)
            for number, found in zip(numbers.ravel(), corners, strict=True):
                ahead = (tag_corners(int(number)) - position) @ rotation
                pixels = ahead @ intrinsics.T
                pixels = pixels[:, :2] / pixels[:, 2:]
                assert np.median(np.linalg.norm(pixels - found[0], axis=1)) < 1.5
                column, row = np.round(pixels.mean(axis=0)).astype(int)
                assert depth[row, column] == pytest.approx(ahead[:, 2].mean(), abs=0.005)
                seen.add(int(number))
    assert seen == set(TAGS)

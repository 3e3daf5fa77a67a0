"""Kinematics and paths: the hand goes where it should, straight and from rest to rest."""

import numpy as np
import pytest

pytest.importorskip("mink", reason="needs the extra `robot`")

from kitchen_prefs_robot.motion.kinematics import hand_pose, kinematics
from kitchen_prefs_robot.motion.moves import JOINT_SPEED, PERIOD, joint_path, line_path
from kitchen_prefs_robot.motion.obstacles import Furniture, Obstacles
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.scene.arm import HOME

DOWN, ACROSS = np.array([0.0, 0.0, -1.0]), np.array([0.0, 1.0, 0.0])


def reached(x, y, z):
    return next(kinematics().reach(hand_pose((x, y, z), DOWN, ACROSS), np.array(HOME)), None)


@pytest.mark.parametrize("place", [(0.4, 0.0, 0.1), (0.5, -0.4, 0.05), (0.6, 0.05, 0.3)])
def test_the_hand_is_where_it_should_be(place):
    pose = kinematics().pose(reached(*place))
    assert pose[:3, 3] == pytest.approx(place, abs=0.001)
    assert pose[:3, 2] == pytest.approx(DOWN, abs=0.01)


@pytest.mark.parametrize("place", [(1.0, 0.0, 0.1), (0.0, 0.0, 2.0)])
def test_a_place_out_of_reach_has_no_solution(place):
    assert reached(*place) is None


def test_a_line_is_straight_and_starts_and_ends_at_rest():
    start = reached(0.45, -0.2, 0.3)
    path = line_path(start, hand_pose((0.45, -0.2, 0.1), DOWN, ACROSS))
    hand = np.array([kinematics().pose(joints)[:3, 3] for joints in path])
    assert np.abs(hand[:, :2] - (0.45, -0.2)).max() < 0.002
    assert hand[-1, 2] == pytest.approx(0.1, abs=0.001)
    speed = np.linalg.norm(np.diff(hand, axis=0), axis=1) / PERIOD
    assert max(speed[0], speed[-1]) < 0.1 * speed.max()


def test_a_line_out_of_reach_is_no_path():
    start = reached(0.45, -0.2, 0.3)
    assert line_path(start, hand_pose((0.95, -0.2, 0.3), DOWN, ACROSS)) is None


def test_joints_keep_to_their_speed():
    end = np.array(HOME) + np.array([1.5, 0.3, 0.0, 0.2, 0.0, 0.0, 0.0])
    path = joint_path(np.array(HOME), end)
    assert path[-1] == pytest.approx(end)
    assert np.abs(np.diff(path, axis=0)).max() / PERIOD == pytest.approx(JOINT_SPEED, rel=0.05)


def test_furniture_is_in_the_way():
    world = World(sample_scene(0))
    obstacles = Obstacles(world, Furniture.true(world))
    start = reached(0.45, -0.2, 0.3)
    above = line_path(start, hand_pose((0.45, -0.2, 0.1), DOWN, ACROSS))
    through = line_path(start, hand_pose((0.45, -0.2, -0.1), DOWN, ACROSS))
    assert not obstacles.strikes(above)
    assert obstacles.strikes(through)


def test_what_the_hand_holds_strikes_a_drawer_that_is_known_to_be_open():
    world = World(sample_scene(0))
    over = joint_path(np.array(HOME), reached(0.40, 0.40, 0.52))
    hanging = np.array([[0.0, 0.0, 0.05]])
    low = hanging + np.array([0.0, 0.0, 0.21])
    opened = Obstacles(world, Furniture({"upper": 0.28, "lower": 0.0}, stands=True))
    assert not opened.strikes(over, hanging)
    assert opened.strikes(over, low)
    world.set_drawer("upper", 0.28)  # which is truly open, but was seen closed
    closed = Obstacles(world, Furniture({"upper": 0.0, "lower": 0.0}, stands=True))
    assert not closed.strikes(over, low)


def test_a_stand_is_in_the_way_only_where_its_place_is_known():
    world = World(sample_scene(0))
    plate = next(dish for dish in world.scene.dishes if dish.on_stand)
    x, y, _ = plate.position
    through = reached(x, y, 0.15)[None]
    assert Obstacles(world, Furniture.true(world)).strikes(through)
    seen = Furniture({"upper": 0.0, "lower": 0.0}, stands=False)
    assert not Obstacles(world, seen).strikes(through)

"""Picks, drops and drawers under physics, and how they fail: in an outcome, soon."""

import numpy as np
import pytest

pytest.importorskip("mink", reason="needs the extra `robot`")

from kitchen_prefs_robot.motion import (
    Furniture,
    Result,
    close_drawer,
    drop,
    open_drawer,
    pick,
    put_back,
)
from kitchen_prefs_robot.motion.seen_points import exact_points, seen_points
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.scene.arm import HOME
from kitchen_prefs_robot.scene.layout import CABINET_POSITION, CABINET_ROTATION, DRAWER_FLOOR

LONGEST = 25.0  # s of simulated time that any motion may take


def bowl_world():
    return World(sample_scene(2, ("small bowl",)))


def points_of(world):
    return exact_points(world, np.random.default_rng(0))[0]


def at_home(world):
    return np.abs(world.data.qpos[:7] - HOME).max() < 0.05


def test_a_bowl_is_picked_and_dropped_into_the_drawer():
    world, frames = bowl_world(), []
    world.set_drawer("lower", 0.28)
    picked = pick(world, *points_of(world), on_frame=lambda w: frames.append(w.data.time))
    assert picked.result is Result.DONE
    assert picked.seconds < LONGEST
    assert len(frames) == pytest.approx(50 * picked.seconds, abs=1)
    assert world.dish_pose(0)[0][2] > 0.3
    dropped = drop(world, "lower", picked)
    assert dropped.result is Result.DONE
    assert at_home(world)
    inside = CABINET_ROTATION.inv().apply(world.dish_pose(0)[0] - CABINET_POSITION)
    assert 0.0 < inside[0] < 0.28
    assert abs(inside[1]) < 0.18
    assert inside[2] == pytest.approx(DRAWER_FLOOR["lower"] + 0.03, abs=0.02)


def test_a_dish_for_a_closed_drawer_is_put_back():
    world = bowl_world()
    before = world.dish_pose(0)[0]
    picked = pick(world, *points_of(world))
    time = world.data.time
    assert drop(world, "upper", picked).result is Result.NOT_OPEN
    assert world.data.time == time
    half_open = Furniture({"upper": 0.2, "lower": 0.0}, stands=False)
    assert drop(world, "upper", picked, furniture=half_open).result is Result.NOT_OPEN
    assert put_back(world, picked).succeeded
    assert world.dish_pose(0)[0] == pytest.approx(before, abs=0.02)
    assert at_home(world)


def test_a_cup_is_picked_as_cameras_see_it():
    world = World(sample_scene(0))
    points, others = seen_points(world, np.random.default_rng(0))[2]
    assert np.linalg.norm(points.mean(axis=0)[:2] - world.dish_pose(2)[0][:2]) < 0.04
    assert pick(world, points, others).succeeded
    assert world.dish_pose(2)[0][2] > 0.2


def test_points_beside_the_dish_miss_it():
    world = bowl_world()
    points, others = points_of(world)
    outcome = pick(world, points + np.array([0.0, 0.0, 0.15]), others)
    assert outcome.result is Result.MISSED
    assert len(outcome.held) == 0
    assert world.dish_pose(0)[0][2] < 0.05
    assert at_home(world)


def test_a_dish_out_of_reach_ends_before_it_begins():
    world = bowl_world()
    world.set_dish_pose(0, (1.0, -0.6, 0.03), (1.0, 0.0, 0.0, 0.0))
    before = world.data.time
    assert pick(world, *points_of(world)).result is Result.UNREACHABLE
    assert pick(world, np.empty((0, 3)), np.empty((0, 3))).result is Result.UNREACHABLE
    assert world.data.time == before


@pytest.mark.parametrize("drawer", ["upper", "lower"])
def test_a_drawer_opens_and_closes(drawer):
    world = bowl_world()
    assert open_drawer(world, drawer).result is Result.DONE
    assert world.drawer_opening(drawer) > 0.26
    time = world.data.time
    assert open_drawer(world, drawer).succeeded  # it is open already
    assert world.data.time == time
    assert close_drawer(world, drawer).result is Result.DONE
    assert world.drawer_opening(drawer) < 0.01
    assert at_home(world)


def test_a_drawer_that_sticks_is_jammed():
    world = bowl_world()
    world.model.joint("lower").range[:] = (0.0, 0.02)
    outcome = open_drawer(world, "lower")
    assert outcome.result is Result.JAMMED
    assert outcome.seconds < LONGEST
    assert world.drawer_opening("lower") < 0.05
    assert at_home(world)

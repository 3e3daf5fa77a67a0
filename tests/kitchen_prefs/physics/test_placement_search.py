"""The committed placements hold under contact physics, and their record describes them."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kitchen_prefs.physics.placement_search import count, geometry_hash, without
from kitchen_prefs.physics.settling import Settler, displacement
from kitchen_prefs.physics.shapes import hull_points
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.layout import RACK_HEADROOM, RACK_INNER
from kitchen_prefs.simulation.placements import load_placements, load_record

CONSTRAINTS = Path(__file__).parents[3] / "constraints.txt"
PLACEMENTS = load_placements()
POSES = np.hstack([PLACEMENTS.position, PLACEMENTS.quaternion]).astype(float)  # (P, 7)


def test_every_dish_is_inside_the_rack_and_lets_it_close():
    for index, pose in zip(PLACEMENTS.category, POSES, strict=True):
        turn = Rotation.from_quat(pose[3:], scalar_first=True)
        points = turn.apply(hull_points(CATEGORIES[index])) + pose[:3]
        assert (np.abs(points[:, :2]).max(axis=0) <= np.array(RACK_INNER) / 2 + 0.003).all()
        assert points[:, 2].max() <= RACK_HEADROOM


def test_the_record_belongs_to_this_scene():
    record = load_record()
    assert record["geometry"] == geometry_hash()
    assert f"mujoco=={record['mujoco']}" in CONSTRAINTS.read_text().splitlines()
    assert record["counts"] == count(PLACEMENTS)


def test_enough_dishes_stay_when_racks_are_carried():
    check = load_record()["truth_check"]
    assert check["sessions"] >= 50
    assert check["stayed"] >= 0.95
    assert check["within"] == {"metres": 0.03, "degrees": 20.0}


@pytest.mark.parametrize("category", range(len(CATEGORIES)), ids=CATEGORIES)
def test_a_sample_settles_where_it_stood(category):
    settler = Settler(CATEGORIES[category])
    for pose in POSES[PLACEMENTS.category == category][::12]:
        rest = settler.settle(pose)
        assert rest is not None
        shift, turn = displacement(pose, rest)
        assert shift < 0.005
        assert turn < np.deg2rad(5.0)


def test_without_removes_rows_and_columns():
    fewer = without(PLACEMENTS, np.array([0, 5]))
    assert len(fewer.category) == len(PLACEMENTS.category) - 2
    assert fewer.blocks.shape == (len(fewer.category),) * 2
    assert np.array_equal(fewer.position[0], PLACEMENTS.position[1])

"""The committed placements, as arrays."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kitchen_prefs.physics.placement_search import KEPT
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.placements import load_placements

PLACEMENTS = load_placements()
POSES = np.hstack([PLACEMENTS.position, PLACEMENTS.quaternion]).astype(float)  # (P, 7)


def test_reading_placements_imports_no_mujoco():
    code = (
        "import sys; from kitchen_prefs.simulation.placements import load_placements;"
        "load_placements(); sys.exit('mujoco' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_shapes_and_types():
    count_all = len(PLACEMENTS.category)
    assert PLACEMENTS.category.dtype == np.int8
    assert PLACEMENTS.position.shape == (count_all, 3)
    assert PLACEMENTS.position.dtype == np.float32
    assert PLACEMENTS.quaternion.shape == (count_all, 4)
    assert PLACEMENTS.quaternion.dtype == np.float32
    assert PLACEMENTS.blocks.shape == (count_all, count_all)
    assert PLACEMENTS.blocks.dtype == bool


def test_placements_are_sorted_and_every_category_has_many():
    assert (np.diff(PLACEMENTS.category) >= 0).all()
    counts = np.bincount(PLACEMENTS.category, minlength=len(CATEGORIES))
    assert counts.max() <= KEPT
    assert counts.min() >= 0.8 * KEPT


def test_quaternions_are_unit_and_canonical():
    assert np.allclose(np.linalg.norm(PLACEMENTS.quaternion, axis=1), 1.0, atol=1e-6)
    assert (PLACEMENTS.quaternion[:, 0] >= 0).all()


def test_the_blocking_table_is_symmetric_and_neither_empty_nor_full():
    blocks = PLACEMENTS.blocks
    assert (blocks == blocks.T).all()
    assert blocks.diagonal().all()
    assert 0.1 < blocks.mean() < 0.5


@pytest.mark.parametrize("category", range(len(CATEGORIES)), ids=CATEGORIES)
def test_poses_of_a_category_differ(category):
    poses = POSES[PLACEMENTS.category == category]
    for index, pose in enumerate(poses):
        shifts = np.linalg.norm(poses[index + 1 :, :3] - pose[:3], axis=1)
        alike = np.abs(poses[index + 1 :, 3:] @ pose[3:]).clip(max=1.0)
        assert ((shifts > 1e-3) | (2 * np.arccos(alike) > 1e-3)).all()


@pytest.mark.parametrize("category", range(len(CATEGORIES)), ids=CATEGORIES)
def test_dishes_stand_as_one_loads_them(category):
    axes = Rotation.from_quat(
        PLACEMENTS.quaternion[PLACEMENTS.category == category], scalar_first=True
    ).as_matrix()[:, :, 2]
    name = CATEGORIES[category]
    if name == "tray" or name.endswith("plate"):
        assert (np.abs(axes[:, 2]) < 0.4).all()  # on their side
    else:
        assert (axes[:, 2] < -0.4).all()  # upside down

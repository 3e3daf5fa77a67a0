"""Grasps from points: across walls, over their edges, clear of all else."""

import numpy as np
import pytest

pytest.importorskip("mink", reason="needs the extra `robot`")

from kitchen_prefs_robot.motion import hand
from kitchen_prefs_robot.motion.grasps import propose_grasps

NOTHING = np.empty((0, 3))
RADIUS, HEIGHT = 0.06, 0.08


@pytest.fixture(scope="module")
def ring():
    """The wall of a cup without a bottom, in front of the arm, (N, 3)."""
    rng = np.random.default_rng(0)
    angle, z = rng.uniform(-np.pi, np.pi, 1200), rng.uniform(0.0, HEIGHT, 1200)
    radius = RADIUS + rng.choice([-0.002, 0.002], 1200)
    return np.stack([0.5 + radius * np.cos(angle), radius * np.sin(angle), z], axis=1)


def test_fingers_close_across_the_wall_over_its_rim(ring):
    grasps = propose_grasps(ring, NOTHING)
    assert len(grasps) > 20
    assert [g.confidence for g in grasps] == sorted((g.confidence for g in grasps), reverse=True)
    for grasp in grasps[:20]:
        place = grasp.pose[:3, 3]
        outwards = (place - (0.5, 0.0, 0.0)) * (1, 1, 0)
        assert np.linalg.norm(outwards) == pytest.approx(RADIUS, abs=0.006)
        assert abs(grasp.pose[:3, 1] @ outwards) / np.linalg.norm(outwards) > 0.9
        assert 0.04 < place[2] < HEIGHT
        assert np.linalg.det(grasp.pose[:3, :3]) == pytest.approx(1.0)


def test_no_grasp_strikes_another_object(ring):
    beside = ring + np.array([0.15, 0.0, 0.0])
    free, crowded = propose_grasps(ring, NOTHING), propose_grasps(ring, beside)
    assert 0 < len(crowded) < len(free)
    for grasp in crowded:
        assert hand.struck((beside - grasp.pose[:3, 3]) @ grasp.pose[:3, :3]) == 0


def test_no_grasp_goes_through_the_table(ring):
    assert propose_grasps(ring - np.array([0.0, 0.0, HEIGHT - 0.015]), NOTHING) == []


SHEET = np.random.default_rng(0).uniform((0.4, 0.0, 0.1), (0.6, 0.2, 0.1001), (800, 3))


@pytest.mark.parametrize("points", [NOTHING, np.full((5, 3), 0.4), SHEET])
def test_points_without_a_wall_have_no_grasp(points):
    assert propose_grasps(points, NOTHING) == []

"""Surfaces as triangles."""

import numpy as np
import pytest

from kitchen_prefs.rendering.meshes import Surface, box, tube, turned


def volume(shape: Surface) -> float:
    first, second, third = (shape.vertices[shape.faces[:, corner]] for corner in range(3))
    return float((first * np.cross(second, third)).sum() / 6)


def test_a_box_has_its_volume():
    assert volume(box((0, 0, 0), (1, 2, 3))) == pytest.approx(6.0)


def test_a_turned_cylinder_has_its_volume():
    outline = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 2.0), (0.0, 2.0)])
    assert volume(turned(outline, 200)) == pytest.approx(2 * np.pi, rel=1e-3)


def test_a_straight_tube_has_its_volume():
    path = np.stack([np.zeros(5), np.zeros(5), np.linspace(0.0, 2.0, 5)], axis=1)
    assert volume(tube(path, 1.0, 200)) == pytest.approx(2 * np.pi, rel=1e-3)

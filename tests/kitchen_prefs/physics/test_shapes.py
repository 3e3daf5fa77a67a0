import numpy as np
import pytest

from kitchen_prefs.physics.shapes import hull_points, solids
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.meshes import Surface, box, tube, turned
from kitchen_prefs.rendering.tableware import colour, surface
from kitchen_prefs.simulation.layout import EXTENTS

TOLERANCE = 0.002  # m: solids and surfaces stay this close to the measured extents


@pytest.mark.parametrize("category", CATEGORIES)
def test_solids_fill_the_extents(category):
    points = hull_points(category)
    assert np.allclose(np.ptp(points, axis=0), EXTENTS[category], atol=TOLERANCE)
    assert np.allclose(points.min(axis=0), -points.max(axis=0), atol=TOLERANCE)


@pytest.mark.parametrize("category", CATEGORIES)
def test_surfaces_fill_the_extents(category):
    points = surface(category, 32).vertices
    assert np.allclose(np.ptp(points, axis=0), EXTENTS[category], atol=TOLERANCE)
    assert np.allclose(points.min(axis=0), -points.max(axis=0), atol=TOLERANCE)


def test_dishes_are_made_of_as_few_solids_as_hollowness_needs():
    counts = {category: len(solids(category)) for category in CATEGORIES}
    assert counts == {
        "cup": 18,
        "glass": 13,
        "tray": 5,
        "small bowl": 25,
        "big bowl": 25,
        "small plate": 13,
        "big plate": 13,
    }


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


@pytest.mark.parametrize("category", CATEGORIES)
def test_a_dish_keeps_its_colour_and_dishes_differ(category):
    assert colour(category, 4) == colour(category, 4)
    assert len({colour(category, number) for number in range(20)}) > 1

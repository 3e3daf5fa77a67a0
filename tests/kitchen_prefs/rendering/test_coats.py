"""Rims and stains: the part of a dish that they cover."""

import numpy as np
import pytest

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.coats import rim, stains, subdivided
from kitchen_prefs.rendering.tableware import surface
from kitchen_prefs.simulation.layout import EXTENTS

THIN = 0.002  # m that coats lie above a dish


def area(shape):
    first, second, third = shape.vertices[shape.faces].swapaxes(0, 1)
    return np.linalg.norm(np.cross(second - first, third - first), axis=1).sum() / 2


def test_a_cut_surface_is_the_same_surface():
    tray = surface("tray", 16)
    fine = subdivided(tray, 2)
    assert len(fine.faces) == 16 * len(tray.faces)
    assert area(fine) == pytest.approx(area(tray))


@pytest.mark.parametrize("category", ["cup", "tray", "big bowl"])
def test_a_rim_is_the_upper_part_of_a_dish(category):
    coat = rim(category, surface(category, 16), 0.25)
    height = EXTENTS[category][2]
    assert coat.vertices[:, 2].min() == pytest.approx(height / 4, abs=THIN)
    assert coat.vertices[:, 2].max() == pytest.approx(height / 2, abs=THIN)


def test_a_plate_has_its_rim_outside():
    coat = rim("big plate", surface("big plate", 32), 0.25)
    distance = np.hypot(*(2 * coat.vertices / EXTENTS["big plate"])[:, :2].T)
    assert 0.7 < distance.min() < distance.max() < 1.05


@pytest.mark.parametrize("category", CATEGORIES)
def test_stains_cover_some_of_a_dish_and_lie_on_it(category):
    dish = surface(category, 56)
    fine = subdivided(dish, 4) if category == "tray" else dish
    coat = stains(category, fine)
    assert 0.1 < area(coat) / area(dish) < 0.5
    assert (np.abs(coat.vertices) <= np.array(EXTENTS[category]) / 2 + THIN).all()

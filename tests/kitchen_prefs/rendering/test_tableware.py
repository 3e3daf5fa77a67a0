"""The dishes' surfaces and glazes."""

import numpy as np
import pytest

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.tableware import colour, surface
from kitchen_prefs.simulation.layout import EXTENTS

TOLERANCE = 0.002  # m: solids and surfaces stay this close to the measured extents


@pytest.mark.parametrize("category", CATEGORIES)
def test_surfaces_fill_the_extents(category):
    points = surface(category, 32).vertices
    assert np.allclose(np.ptp(points, axis=0), EXTENTS[category], atol=TOLERANCE)
    assert np.allclose(points.min(axis=0), -points.max(axis=0), atol=TOLERANCE)


@pytest.mark.parametrize("category", CATEGORIES)
def test_a_dish_keeps_its_colour_and_dishes_differ(category):
    assert colour(category, 4) == colour(category, 4)
    assert len({colour(category, number) for number in range(20)}) > 1

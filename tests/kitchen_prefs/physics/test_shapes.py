"""The dishes as solids."""

import numpy as np
import pytest

from kitchen_prefs.physics.shapes import hull_points, solids
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.layout import EXTENTS

TOLERANCE = 0.002  # m: solids and surfaces stay this close to the measured extents


@pytest.mark.parametrize("category", CATEGORIES)
def test_solids_fill_the_extents(category):
    points = hull_points(category)
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

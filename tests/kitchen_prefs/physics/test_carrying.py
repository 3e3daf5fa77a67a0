"""Dishes in a rack that slides in."""

import numpy as np

from kitchen_prefs.physics.carrying import carry
from kitchen_prefs.simulation.placements import load_placements

INVERTED = (0.0, 1.0, 0.0, 0.0)
GLASS = 1  # index in CATEGORIES


def test_a_carried_dish_stays_and_a_badly_stood_one_does_not():
    placements = load_placements()
    index = int(np.argmax(placements.category == GLASS))
    good = np.concatenate([placements.position[index], placements.quaternion[index]])
    on_a_tine = np.array([0.145, 0.0, 0.15, *INVERTED])
    assert carry(["glass"], good[None].astype(float)).tolist() == [True]
    assert carry(["glass"], on_a_tine[None]).tolist() == [False]

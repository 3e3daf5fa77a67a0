"""Dishes dropped into a rack."""

import numpy as np
import pytest

from kitchen_prefs.physics.settling import Settler, displacement

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
INVERTED = (0.0, 1.0, 0.0, 0.0)
FREE_SPOT = (0.0875, 0.0)  # between the two rows of short tines


def test_an_upright_glass_is_rejected_and_an_inverted_one_kept():
    settler = Settler("glass")
    assert settler.settle(np.array([*FREE_SPOT, 0.075, *UPRIGHT])) is None
    rest = settler.settle(np.array([*FREE_SPOT, 0.075, *INVERTED]))
    assert rest is not None
    assert rest[2] == pytest.approx(0.068, abs=0.003)  # MuJoCo 3.8 and 4.0 differ by 3 mm


def test_a_glass_half_outside_the_rack_is_rejected():
    assert Settler("glass").settle(np.array([0.30, 0.0, 0.20, *INVERTED])) is None


def test_a_plate_lying_flat_is_rejected():
    assert Settler("big plate").settle(np.array([0.0, 0.0, 0.15, *UPRIGHT])) is None


def test_the_same_seed_settles_the_same_pose():
    first, second = (
        next(Settler("small bowl").settled(np.random.default_rng(5))) for _ in range(2)
    )
    assert np.array_equal(first, second)


def test_displacement_measures_shift_and_turn():
    quarter = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    shift, turn = displacement(np.array([0.0, 0, 0, *UPRIGHT]), np.array([0.0, 3, 4, *quarter]))
    assert shift == pytest.approx(5.0)
    assert turn == pytest.approx(np.pi / 2)

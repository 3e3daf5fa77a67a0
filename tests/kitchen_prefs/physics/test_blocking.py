"""Which placements block each other."""

import numpy as np

from kitchen_prefs.physics.blocking import blocking_table

UPRIGHT = (1.0, 0.0, 0.0, 0.0)
INVERTED = (0.0, 1.0, 0.0, 0.0)
GLASS, SMALL_BOWL, BIG_BOWL = 1, 3, 4  # indices in CATEGORIES


def test_neighbours_block_and_distant_dishes_do_not():
    def glass(x: float) -> list[float]:
        return [x, 0.0, 0.069, *INVERTED]

    blocks = blocking_table(np.full(3, GLASS), np.array([glass(0.0), glass(0.101), glass(0.105)]))
    assert blocks.tolist() == [[True, True, False], [True, True, True], [False, True, True]]


def test_a_bowl_may_not_nest_in_another():
    nested = np.array([[0.0, 0.0, 0.05, *UPRIGHT], [0.0, 0.0, 0.10, *UPRIGHT]])
    assert blocking_table(np.array([BIG_BOWL, SMALL_BOWL]), nested).all()

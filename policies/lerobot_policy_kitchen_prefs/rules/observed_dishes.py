"""Dishes of the second tier as the rows of an instance set show them."""

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.people.attributes import EXTENTS, RGB, DescribedDishes
from lerobot_policy_kitchen_prefs.common.categories import category_at_any_size
from lerobot_policy_kitchen_prefs.common.dish_locations import in_rack, on_counter


def dishes_of(rows: np.ndarray, present: int) -> DescribedDishes:
    """The dishes that some rows describe, in the order of the rows.

    Args:
        rows: Rows of dishes, (n, 21).
        present: How many of them stand on the counter at the start.
    """
    category, scale = category_at_any_size(rows, EXTENTS)
    to_colour = np.abs(rows[:, None, instances.RGB] - RGB).sum(axis=2)  # (n, 4)
    return DescribedDishes(
        category=category.astype(np.int8),
        pose=rows[:, instances.POSE],
        present=present,
        material=rows[:, instances.MATERIAL].argmax(axis=1).astype(np.int8),
        colour=to_colour.argmin(axis=1).astype(np.int8),
        greasy=rows[:, instances.SOIL] > 0,
        scale=scale.astype(np.float32),
    )


def counter_rows(rows: np.ndarray) -> np.ndarray:
    """The dishes on the counter, the one in hand included, (k, 21)."""
    return rows[on_counter(rows) & _is_described(rows)]


def racked_rows(rows: np.ndarray) -> np.ndarray:
    """The dishes in the rack that is out, (k, 21)."""
    return rows[in_rack(rows) & (rows[:, instances.IS_OBJECT] > 0) & _is_described(rows)]


def looks_of(rows: np.ndarray) -> np.ndarray:
    """What rows say of their dish wherever it is: extents, colour, material and soil, (n, 11)."""
    return np.hstack([rows[:, instances.EXTENTS], rows[:, instances.COLUMNS :]])


def _is_described(rows: np.ndarray) -> np.ndarray:
    """Which rows have a material, as those of dishes and places, unlike the door's, (n,) bool."""
    return rows[:, instances.MATERIAL].sum(axis=1) > 0

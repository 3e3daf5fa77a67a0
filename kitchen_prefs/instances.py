"""The row of an instance set, and the sets padded to one constant shape.

An instance is what a decision may look at: the door, a rack, a dish, or a place for the dish in
hand (paper, section 2). One instance is one row of 13 numbers:

     0  1  2   3  4  5   6  7  8  9     10        11         12
    [extents | position | quaternion | decision | is object | is place]
       m          m        w x y z      index      0 or 1      0 or 1

A set has as many rows as there are instances. LeRobot stores constant shapes only, so sets are
padded with rows of zeros to `CAPACITY`; a real row is an object or a place, so it is never zero.
LeRobot's tools take flat columns alone, so data sets, and LeRobot's environments, have a set as its
rows one after the other, (936,); `as_rows` gives the rows.

A prompt is a whole demonstration: the sets of all its decisions, one below the other, with a
fourteenth column that marks the row which each decision chose.
"""

from typing import Any

import numpy as np

EXTENTS = slice(0, 3)
POSITION = slice(3, 6)
QUATERNION = slice(6, 10)
POSE = slice(3, 10)
DECISION = 10
IS_OBJECT = 11
IS_PLACE = 12
COLUMNS = 13

# The second tier's rows have eight more: what a dish is beside its category.
RGB = slice(13, 16)
MATERIAL = slice(16, 20)  # one-hot, in the order of people.attributes.MATERIALS
SOIL = 20
DESCRIBED_COLUMNS = 21

# The largest place set: door, two racks, twenty dishes, 48 placements of a category and the sink.
CAPACITY = 3 + 20 + 48 + 1
DESCRIBED_CAPACITY = 3 + 24 + 48 + 1
FLAT_SIZE = CAPACITY * COLUMNS

CHOSEN = 13  # the prompt's last column
PROMPT_COLUMNS = 14
# A prompt has at most 14 dishes, each picked among 17 rows and placed among 66, and at most 26
# toggles among 17 rows, 6 to load what is there and 20 for what arrives later: 1604 rows.
PROMPT_CAPACITY = 1664
# In the second tier, at most 18 dishes, each picked among 21 rows and placed among 70, and some 18
# toggles among 21 rows: 2016.
PEOPLE_PROMPT_CAPACITY = 2048


def pack(rows: np.ndarray, capacity: int = CAPACITY) -> np.ndarray:
    """Pad a set with zero rows.

    Args:
        rows: The set, (n, D).
        capacity: The number of rows of the result.

    Returns:
        The padded set, (capacity, D) float32.

    Raises:
        ValueError: If the set has more rows than fit.
    """
    if len(rows) > capacity:
        raise ValueError(f"A set of {len(rows)} rows does not fit the capacity of {capacity}.")
    padded = np.zeros((capacity, rows.shape[1]), dtype=np.float32)
    padded[: len(rows)] = rows
    return padded


def unpad(instances: np.ndarray) -> np.ndarray:
    """Give back the set that `pack` padded.

    Args:
        instances: A padded set, (N, D), or flat, (N 13,).

    Returns:
        The rows that are objects or places, (n, D).
    """
    rows = instances.reshape(-1, COLUMNS) if instances.ndim == 1 else instances
    return rows[is_real(rows)]


# The following take NumPy arrays and torch tensors alike, with any number of leading dimensions.


def as_rows(sets: Any) -> Any:
    """Sets as rows, (..., N, 13), from such sets or from flat ones, (..., N 13)."""
    if sets.shape[-1] == COLUMNS:
        return sets
    return sets.reshape(*sets.shape[:-1], -1, COLUMNS)


def is_real(rows: Any) -> Any:
    """Which rows, (..., D), are objects or places and not padding, (...) bool."""
    return rows[..., IS_OBJECT] + rows[..., IS_PLACE] > 0


def is_place_decision(sets: Any) -> Any:
    """Which sets, (..., N, D), belong to place decisions, those with places, (...) bool."""
    return (sets[..., IS_PLACE] > 0).any(-1)


def choosable(sets: Any) -> Any:
    """The rows that decisions may choose: the places if there are any, else the objects.

    Args:
        sets: Sets, padded or not, (..., N, D).

    Returns:
        A mask, (..., N) bool.
    """
    is_place, is_object = sets[..., IS_PLACE] > 0, sets[..., IS_OBJECT] > 0
    return is_place | (is_object & ~is_place_decision(sets)[..., None])

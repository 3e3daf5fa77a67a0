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

A row of the second tier has eight columns more, and its sets more rows: (76, 21), or flat (1596,).
The size says which, so all functions here take sets of both tiers, as rows or flat.

A prompt is a whole demonstration: the sets of all its decisions, one below the other, with one more
column, the last, that marks the row which each decision chose.
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
DESCRIBED_FLAT_SIZE = DESCRIBED_CAPACITY * DESCRIBED_COLUMNS
COLUMNS_OF_FLAT = {FLAT_SIZE: COLUMNS, DESCRIBED_FLAT_SIZE: DESCRIBED_COLUMNS}

CHOSEN = 13  # the last column of the first tier's prompts
PROMPT_COLUMNS = 14
# A prompt has at most 14 dishes, each picked among 17 rows and placed among 66, and at most 26
# toggles among 17 rows, 6 to load what is there and 20 for what arrives later: 1604 rows.
PROMPT_CAPACITY = 1664
# In the second tier, at most 18 dishes, each picked among 21 rows and placed among 70, and some 18
# toggles among 21 rows: 2016.
PEOPLE_PROMPT_CAPACITY = 2048

# The number of rows that sets, and prompts, are padded to, by the columns of a set's rows.
CAPACITIES = {COLUMNS: CAPACITY, DESCRIBED_COLUMNS: DESCRIBED_CAPACITY}
PROMPT_CAPACITIES = {COLUMNS: PROMPT_CAPACITY, DESCRIBED_COLUMNS: PEOPLE_PROMPT_CAPACITY}


def pack(rows: np.ndarray, capacity: int | None = None) -> np.ndarray:
    """Pad a set with zero rows.

    Args:
        rows: The set, (n, D).
        capacity: The number of rows of the result; None takes that of the tier's sets.

    Returns:
        The padded set, (capacity, D) float32.

    Raises:
        ValueError: If the set has more rows than fit.
    """
    if capacity is None:
        capacity = CAPACITIES[rows.shape[1]]
    if len(rows) > capacity:
        raise ValueError(f"A set of {len(rows)} rows does not fit the capacity of {capacity}.")
    padded = np.zeros((capacity, rows.shape[1]), dtype=np.float32)
    padded[: len(rows)] = rows
    return padded


def unpad(instances: np.ndarray) -> np.ndarray:
    """Give back the set that `pack` padded.

    Args:
        instances: A padded set, (N, D), or flat, (N D,).

    Returns:
        The rows that are objects or places, (n, D).
    """
    rows = as_rows(instances)
    return rows[is_real(rows)]


# The following take NumPy arrays and torch tensors alike, with any number of leading dimensions.


def as_rows(sets: Any) -> Any:
    """Sets as rows, (..., N, D), from such sets or from flat ones, (..., N D)."""
    columns = COLUMNS_OF_FLAT.get(sets.shape[-1])
    return sets if columns is None else sets.reshape(*sets.shape[:-1], -1, columns)


def is_real(sets: Any) -> Any:
    """Which rows of sets, (..., N, D) or flat, are no padding, (..., N) bool."""
    rows = as_rows(sets)
    return rows[..., IS_OBJECT] + rows[..., IS_PLACE] > 0


def is_place_decision(sets: Any) -> Any:
    """Which sets, (..., N, D) or flat, belong to place decisions and have places, (...) bool."""
    return (as_rows(sets)[..., IS_PLACE] > 0).any(-1)


def choosable(sets: Any) -> Any:
    """The rows that decisions may choose: the places if there are any, else the objects.

    Args:
        sets: Sets, padded or not, (..., N, D) or flat.

    Returns:
        A mask, (..., N) bool.
    """
    rows = as_rows(sets)
    is_place, is_object = rows[..., IS_PLACE] > 0, rows[..., IS_OBJECT] > 0
    return is_place | (is_object & ~is_place_decision(rows)[..., None])

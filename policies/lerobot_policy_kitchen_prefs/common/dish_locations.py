"""Where a dish is: on the counter, or in the top or the bottom rack.

A closed rack is not visible, and a rack that is out is in front of the counter and below its top.
All functions take NumPy arrays and torch tensors alike, with any number of leading dimensions.
"""

from typing import Any

from kitchen_prefs.instances import IS_OBJECT, POSITION
from kitchen_prefs.simulation.layout import COUNTER_HEIGHT, RACK_CLOSED, SINK_CENTRE, SINK_SIZE

X, Y, Z = range(POSITION.start, POSITION.stop)

# Each bound leaves 10 cm or more on both sides, ten standard deviations of perception's errors.
COUNTER_LEVEL = COUNTER_HEIGHT - 0.1  # m; dishes on the counter are above it
SINK_FRONT = SINK_CENTRE[1] - SINK_SIZE[1] / 2  # m; dishes in a rack are in front of it
TOP_RACK_LEVEL = RACK_CLOSED["top"][2]  # m; the floor of the top rack
RACK_MIDDLE = RACK_CLOSED["top"][0]  # m; both racks have a left and a right half

ZONES = 4  # the halves of the top and of the bottom rack
ELSEWHERE = ZONES  # in the sink, or on the counter


def in_rack(rows: Any) -> Any:
    """Which dishes or places, rows (..., D), are in a rack that is out, (...) bool."""
    return (rows[..., Z] < COUNTER_LEVEL) & (rows[..., Y] < SINK_FRONT)


def in_top_rack(rows: Any) -> Any:
    """Which of the rows in a rack, (..., D), are in the top one, (...) bool."""
    return rows[..., Z] > TOP_RACK_LEVEL


def on_counter(rows: Any) -> Any:
    """Which dishes, rows (..., D), are on the counter, (...) bool."""
    return (rows[..., IS_OBJECT] > 0) & ~in_rack(rows)


def zone_of(rows: Any) -> Any:
    """The zones of dishes or places, rows (..., D), (...) int: one of ZONES, or ELSEWHERE.

    Top left, top right, bottom left, bottom right, as in `kitchen_prefs.people.zones`.
    """
    racked = in_rack(rows)
    zone = 2 * ~in_top_rack(rows) + 1 * (rows[..., X] >= RACK_MIDDLE)
    return racked * zone + ~racked * ELSEWHERE

"""The four zones, halves of the racks, and where a dish goes when its own is full."""

from functools import cache

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation.kitchen import (
    FIRST_PLACEMENT,
    SINK,
    Kitchen,
    PlacementTable,
    rack_position,
)

# A placement lies in the half on whose side its middle is.
ZONES = ("top left", "top right", "bottom left", "bottom right")
RACK_OF_ZONE = ("top", "top", "bottom", "bottom")
SINK_ZONE = len(ZONES)  # washed by hand, or nothing is free
LEFT = SINK_ZONE + 1  # where a dish is that was not put away

# What happens when a zone is full: for each zone those that are tried, its own first.
OVERFLOWS = {
    "other side, then other rack": ((0, 1, 2, 3), (1, 0, 3, 2), (2, 3, 0, 1), (3, 2, 1, 0)),
    "other rack, then other side": ((0, 2, 1, 3), (1, 3, 0, 2), (2, 0, 3, 1), (3, 1, 2, 0)),
    "sink": ((0,), (1,), (2,), (3,)),
}
# The same with the sink at the end of each list, and for a dish washed by hand the sink alone.
LONGEST = len(ZONES) + 1
TRIED = np.array(
    [
        [[*tried, *[SINK_ZONE] * (LONGEST - len(tried))] for tried in (*lists, ())]
        for lists in OVERFLOWS.values()
    ]
)  # (3, 5, 5): overflow, zone, the zones in the order in which they are tried
OVERFLOW_INDEX = {name: index for index, name in enumerate(OVERFLOWS)}
IS_IN_RACK = {rack: np.array([own == rack for own in (*RACK_OF_ZONE, "")]) for rack in RACKS}


def targets_now(kitchen: Kitchen) -> np.ndarray:
    """Where dishes would go now, the first zone of a list with a free placement.

    Returns:
        For each overflow, category and zone that a dish should go to, (3, 7, 5) int: a zone, or
        SINK_ZONE.
    """
    free = np.ones((len(CATEGORIES), LONGEST), dtype=bool)  # the sink always is
    free[:, :SINK_ZONE] = free_zones(kitchen)
    first = free[:, TRIED].argmax(axis=-1)  # (7, 3, 5)
    return np.moveaxis(np.take_along_axis(TRIED[None], first[..., None], -1)[..., 0], 0, 1)


def zone_of_place(kitchen: Kitchen, instance: int) -> int:
    """The zone of a place: of a placement in the rack that is out, or SINK_ZONE."""
    if instance == SINK:
        return SINK_ZONE
    assert kitchen.open_rack is not None
    rack = kitchen.open_rack
    return int(zone_of_placements(kitchen.table)[rack][instance - FIRST_PLACEMENT[rack]])


def free_zones(kitchen: Kitchen) -> np.ndarray:
    """Which zones have a free placement for which category, (7, 4) bool."""
    zone = zone_of_placements(kitchen.table)
    free = np.zeros((len(CATEGORIES), len(ZONES)), dtype=bool)
    for rack in RACKS:
        for category in range(len(CATEGORIES)):
            free[category, zone[rack][kitchen.free(rack, category)]] = True
    return free


@cache
def zone_of_placements(table: PlacementTable) -> dict[str, np.ndarray]:
    """The zone of each placement, rack -> (P,) int."""
    return {
        rack: RACK_OF_ZONE.index(rack) + (table.pose[rack][:, 0] >= rack_position(rack, True)[0])
        for rack in RACKS
    }

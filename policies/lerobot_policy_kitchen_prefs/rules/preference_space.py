"""All 2 x 7! preferences as arrays, and the expert's choice under each of them."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, RACKS, SPACE_SIZE, preference_from_number
from lerobot_policy_kitchen_prefs.rules.observed_view import ObservedView


@dataclass(frozen=True, eq=False)
class PreferenceSpace:
    """All P preferences, in the order of their numbers; a rack is an index into RACKS.

    Attributes:
        first: The rack that is loaded first, (P,).
        rack: The rack of each category, (P, 7).
        rank: The rank of each category in its rack's order, (P, 7).
        partitions: The 35 partitions into three categories of the top rack and four of the bottom
            rack, (35, 7).
        partition: The index of each preference's partition, (P,).
    """

    first: np.ndarray
    rack: np.ndarray
    rank: np.ndarray
    partitions: np.ndarray
    partition: np.ndarray


@cache
def preference_space() -> PreferenceSpace:
    """The space of all preferences."""
    preferences = [preference_from_number(number) for number in range(SPACE_SIZE)]
    rack = np.array([[RACKS.index(p.rack_of[c]) for c in CATEGORIES] for p in preferences])
    partitions, partition = np.unique(rack, axis=0, return_inverse=True)
    return PreferenceSpace(
        first=np.array([RACKS.index(p.first) for p in preferences]),
        rack=rack,
        rank=np.array([[p.rank_of[c] for c in CATEGORIES] for p in preferences]),
        partitions=partitions,
        partition=partition.ravel(),
    )


def expert_choices(view: ObservedView) -> np.ndarray:
    """The result of `kitchen_prefs.simulation.expert.choose` under each preference.

    Args:
        view: The view before the decision.

    Returns:
        The chosen rows, (P,).
    """
    if view.held is not None:
        return _places(view)
    space = preference_space()
    nearest = _nearest_dish(view)  # (7,)
    waiting = nearest >= 0
    if view.open_rack is not None:
        mine = waiting & (space.rack == RACKS.index(view.open_rack))  # (P, 7)
        return np.where(mine.any(axis=1), _next_dish(mine, nearest), view.racks[view.open_rack])
    fits = np.array([[view.fits(rack, c) for c in CATEGORIES] for rack in RACKS])  # (2, 7)
    opening = np.array([view.racks[rack] if view.door_open else view.door for rack in RACKS])
    chosen: np.ndarray = np.full(len(space.first), view.door)
    for rack in (1 - space.first, space.first):  # the first rack overrides the other
        mine = waiting & (space.rack == rack[:, None])  # (P, 7)
        chosen = np.where(mine.any(axis=1), _next_dish(mine, nearest), chosen)
        chosen = np.where((mine & fits[rack]).any(axis=1), opening[rack], chosen)
    return chosen


def _places(view: ObservedView) -> np.ndarray:
    """The place of the dish in hand under each preference, (P,) rows."""
    racks = preference_space().rack[:, CATEGORIES.index(str(view.held))]  # (P,)
    free = view.free_placements()
    if view.open_rack is None or not free:
        return np.full(len(racks), view.sink)
    nearest = min(free, key=lambda option: option.nearness).choice
    return np.where(racks == RACKS.index(view.open_rack), nearest, view.sink)


def _nearest_dish(view: ObservedView) -> np.ndarray:
    """The waiting dish of each category that is taken first, -1 where none waits, (7,) rows."""
    nearest = np.full(len(CATEGORIES), -1)
    for option in sorted(view.waiting(), key=lambda option: option.nearness, reverse=True):
        nearest[CATEGORIES.index(option.category)] = option.choice
    return nearest


def _next_dish(mine: np.ndarray, nearest: np.ndarray) -> np.ndarray:
    """The dish of the lowest rank among a rack's waiting categories, (P, 7) -> (P,) rows."""
    return nearest[np.where(mine, preference_space().rank, len(CATEGORIES)).argmin(axis=1)]

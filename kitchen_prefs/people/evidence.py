"""What a demonstration says of its user: where each dish may belong, what came before what.

The expert is deterministic, so every decision rules something out. Given the overflow and the rack
that is loaded first, what it rules out concerns one dish at a time:

    a dish is placed                   its target is that zone
    it is picked with a rack out       its target is in that rack
    a rack is pushed in                no waiting dish has its target there
    the second rack is pulled out      no waiting dish has its target in the first
    it is picked with both racks in    no waiting dish has a target
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from kitchen_prefs.people.attributes import DescribedDishes
from kitchen_prefs.people.expert import place_by_style
from kitchen_prefs.people.users import STYLES
from kitchen_prefs.people.zones import (
    IS_IN_RACK,
    LONGEST,
    OVERFLOWS,
    SINK_ZONE,
    targets_now,
    zone_of_place,
    zone_of_placements,
)
from kitchen_prefs.preferences import RACKS
from kitchen_prefs.simulation.expert import nearness_to_sink
from kitchen_prefs.simulation.kitchen import (
    FIRST_DISH,
    FIRST_PLACEMENT,
    RACK_OF_INSTANCE,
    Kitchen,
    PlacementTable,
)


@dataclass(frozen=True, eq=False)
class Evidence:
    """What one demonstration says, or several of one user together, n dishes in all.

    Attributes:
        dishes: The dishes.
        allowed: For each rack that may be the first (in the order of RACKS) and each overflow, the
            zones that each dish may belong to, the last of them washed by hand, (2, 3, n, 5) bool.
        taken: A dish that was taken while another one waited that could have been, (k,) int.
        waiting: That other one, (k,) int.
        nearer: Whether the one that was taken is the nearer to the sink, (k,) bool.
        styles: Which styles place every dish where it was placed, (4,) bool.
    """

    dishes: DescribedDishes
    allowed: np.ndarray
    taken: np.ndarray
    waiting: np.ndarray
    nearer: np.ndarray
    styles: np.ndarray


@dataclass(frozen=True, eq=False)
class _Pick:
    dish: int
    others: np.ndarray  # that waited, (w,)
    could_be: np.ndarray  # whether a dish could be taken, by overflow, dish and zone, (3, n, 5)


# What somebody says of whom no demonstration is known.
NOTHING = Evidence(
    dishes=DescribedDishes(
        category=np.empty(0, np.int8),
        pose=np.empty((0, 7), np.float32),
        present=0,
        material=np.empty(0, np.int8),
        colour=np.empty(0, np.int8),
        greasy=np.empty(0, bool),
        scale=np.empty(0, np.float32),
    ),
    allowed=np.ones((len(RACKS), len(OVERFLOWS), 0, LONGEST), dtype=bool),
    taken=np.empty(0, dtype=int),
    waiting=np.empty(0, dtype=int),
    nearer=np.empty(0, dtype=bool),
    styles=np.ones(len(STYLES), dtype=bool),
)


def evidence_of(
    dishes: DescribedDishes, table: PlacementTable, decisions: Sequence[int]
) -> Evidence:
    """Read a demonstration.

    Args:
        dishes: The session's dishes.
        table: Where they can stand.
        decisions: The chosen instances, none of them refused.
    """
    kitchen = Kitchen(dishes, table)
    n = len(dishes.category)
    allowed = np.ones((len(RACKS), len(OVERFLOWS), n, LONGEST), dtype=bool)
    styles = np.ones(len(STYLES), dtype=bool)
    picks = []
    for instance in decisions:
        targets = targets_now(kitchen)[:, dishes.category]  # (3, n, 5)
        waiting = kitchen.counter
        if kitchen.held is not None:
            zone = zone_of_place(kitchen, instance)
            allowed[:, :, kitchen.held] &= targets[:, kitchen.held] == zone
            if zone != SINK_ZONE:
                styles &= _styles_that_place(kitchen, instance)
        elif instance >= FIRST_DISH:
            dish = instance - FIRST_DISH
            rack = kitchen.open_rack
            could_be = IS_IN_RACK[rack][targets] if rack else targets == SINK_ZONE
            told = np.array([dish]) if rack else waiting
            allowed[:, :, told] &= could_be[:, told]
            picks.append(_Pick(dish, waiting[waiting != dish], could_be))
        elif instance in RACK_OF_INSTANCE:
            _exclude(allowed, kitchen, RACK_OF_INSTANCE[instance], targets, waiting)
        kitchen.decide(instance)
    return Evidence(dishes, allowed, *_order_of(picks, allowed, dishes), styles)


def joined(evidence: Sequence[Evidence]) -> Evidence:
    """The evidence of several demonstrations of one user together."""
    starts = np.cumsum([0, *(len(one.dishes.category) for one in evidence)])
    return Evidence(
        dishes=joined_dishes([one.dishes for one in evidence]),
        allowed=np.concatenate([one.allowed for one in evidence], axis=2),
        taken=np.concatenate([s + one.taken for s, one in zip(starts, evidence, strict=False)]),
        waiting=np.concatenate([s + one.waiting for s, one in zip(starts, evidence, strict=False)]),
        nearer=np.concatenate([one.nearer for one in evidence]),
        styles=np.logical_and.reduce([one.styles for one in evidence]),
    )


def joined_dishes(several: Sequence[DescribedDishes]) -> DescribedDishes:
    """The dishes of several sessions, one after the other."""
    names = [field.name for field in fields(DescribedDishes) if field.name != "present"]
    together = {name: np.concatenate([getattr(one, name) for one in several]) for name in names}
    return DescribedDishes(present=sum(one.present for one in several), **together)


def _exclude(
    allowed: np.ndarray, kitchen: Kitchen, rack: str, targets: np.ndarray, waiting: np.ndarray
) -> None:
    """Rule out what a user who moves a rack now does not want."""
    if kitchen.open_rack == rack:  # pushed in
        allowed[:, :, waiting] &= ~IS_IN_RACK[rack][targets[:, waiting]]
        return
    for index, first in enumerate(RACKS):
        if first != rack:  # the second is pulled out
            allowed[index, :, waiting] &= ~np.moveaxis(IS_IN_RACK[first][targets[:, waiting]], 0, 1)


def _styles_that_place(kitchen: Kitchen, instance: int) -> np.ndarray:
    """Which styles choose a placement for the dish in hand within its zone, (4,) bool."""
    rack, held = kitchen.open_rack, kitchen.held
    assert rack is not None
    assert held is not None
    zone = zone_of_placements(kitchen.table)[rack]
    placement = instance - FIRST_PLACEMENT[rack]
    free = kitchen.free(rack, int(kitchen.dishes.category[held]))
    free = free[zone[free] == zone[placement]]
    choices = [place_by_style(kitchen, style, free, rack, held) for style in STYLES]
    return np.array(choices) == placement


def _order_of(
    picks: Sequence[_Pick], allowed: np.ndarray, dishes: DescribedDishes
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The pairs of a dish that was taken and one that could have been; see `Evidence`.

    A dish of which it is not certain that it could have been taken makes no pair.
    """
    consistent = np.all(allowed.any(axis=3), axis=2)  # (2, 3)
    possible = (allowed & consistent[:, :, None, None]).any(axis=0)  # (3, n, 5)
    pairs = []
    for pick in picks:
        certain = np.all(pick.could_be | ~possible, axis=(0, 2))  # (n,)
        pairs += [(pick.dish, int(other)) for other in pick.others[certain[pick.others]]]
    taken, waiting = np.array(pairs, dtype=int).reshape(-1, 2).T
    nearness = np.array([nearness_to_sink(pose)[0] for pose in dishes.pose])
    return taken, waiting, nearness[taken] < nearness[waiting]

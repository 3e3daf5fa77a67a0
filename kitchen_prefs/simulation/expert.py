"""The scripted expert: loads by a preference, and from any reachable state it finishes.

It loads the preferred rack first, category by category in the preferred order; within a category it
takes the dish nearest to the sink, and puts it at the free placement nearest to the rack's far left
corner. What no longer fits goes to the sink. It closes one rack before it opens the other, and it
remembers what it put into a closed one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import dist
from typing import Protocol

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, RACKS, Preference
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.kitchen import (
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    RACK_INSTANCE,
    SINK,
    Kitchen,
    PlacementTable,
    decision_kind,
    rack_position,
)

Nearness = tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Option:
    """Something that the expert may choose: a dish on the counter or a free placement.

    Attributes:
        category: The dish's category.
        nearness: Sorts the options of one category; smaller is taken first.
        choice: What names it: an instance's number or a row.
    """

    category: str
    nearness: Nearness
    choice: int


class View(Protocol):
    """What the expert acts upon: the kitchen itself, or a policy's observation of it."""

    door: int  # the choices that name the door, the racks and the sink
    racks: dict[str, int]
    sink: int

    @property
    def door_open(self) -> bool:
        """Whether the door is open."""

    @property
    def open_rack(self) -> str | None:
        """The rack that is pulled out, or None."""

    @property
    def held(self) -> str | None:
        """The category in hand, or None."""

    def waiting(self) -> Sequence[Option]:
        """The dishes on the counter."""

    def free_placements(self) -> Sequence[Option]:
        """The free placements of the pulled-out rack for the category in hand."""

    def fits(self, rack: str, category: str) -> bool:
        """Whether a rack has a free placement for a category, as far as is known."""


def choose(view: View, preference: Preference) -> int:
    """The expert's next decision.

    Args:
        view: What the expert knows. The kitchen must not be finished.
        preference: The user's preference.

    Returns:
        The choice that names the chosen instance.
    """
    if view.held is not None:
        return _where_to_put(view, preference)
    waiting = view.waiting()
    if view.open_rack is not None:
        mine = [
            option for option in waiting if preference.rack_of[option.category] == view.open_rack
        ]
        return _next_dish(mine, preference) if mine else view.racks[view.open_rack]
    for rack in preference.racks:
        mine = [option for option in waiting if preference.rack_of[option.category] == rack]
        if any(view.fits(rack, option.category) for option in mine):
            return view.racks[rack] if view.door_open else view.door
        if mine:
            return _next_dish(mine, preference)
    return view.door


def _next_dish(options: Sequence[Option], preference: Preference) -> int:
    rank = preference.rank_of
    return min(options, key=lambda option: (rank[option.category], option.nearness)).choice


def _where_to_put(view: View, preference: Preference) -> int:
    if view.held is None or preference.rack_of[view.held] != view.open_rack:
        return view.sink
    free = view.free_placements()
    return min(free, key=lambda option: option.nearness).choice if free else view.sink


def nearness_to_sink(pose: np.ndarray) -> Nearness:
    """How near a dish, (7,), is to the sink; its pose breaks ties, so row order never matters."""
    values = pose.tolist()
    return (dist(values[:2], layout.SINK_CENTRE), *values)


def nearness_to_corner(pose: np.ndarray, rack: str) -> Nearness:
    """How near a placement, (7,), is to the far left corner of the rack that is out, from above.

    Filling up from a corner leaves the largest gap for what comes later.
    """
    x, y, _ = rack_position(rack, out=True)
    corner = (x - layout.RACK_INNER[0] / 2, y + layout.RACK_INNER[1] / 2)
    values = pose.tolist()
    return (dist(values[:2], corner), *values)


@cache
def placement_nearness(table: PlacementTable) -> dict[str, list[Nearness]]:
    """`nearness_to_corner` of every placement in a table, rack -> P of them."""
    return {rack: [nearness_to_corner(pose, rack) for pose in table.pose[rack]] for rack in RACKS}


class KitchenView:
    """The kitchen itself: the expert knows what a closed rack holds."""

    door = DOOR
    racks = RACK_INSTANCE
    sink = SINK

    def __init__(self, kitchen: Kitchen) -> None:
        self.kitchen = kitchen
        self._categories = [CATEGORIES[c] for c in kitchen.dishes.category]
        self._nearness = [nearness_to_sink(pose) for pose in kitchen.dishes.pose]

    @property
    def door_open(self) -> bool:
        """Whether the door is open."""
        return self.kitchen.door_open

    @property
    def open_rack(self) -> str | None:
        """The rack that is pulled out, or None."""
        return self.kitchen.open_rack

    @property
    def held(self) -> str | None:
        """The category in hand, or None."""
        return None if self.kitchen.held is None else self._categories[self.kitchen.held]

    def waiting(self) -> list[Option]:
        """The dishes on the counter."""
        return [
            Option(self._categories[dish], self._nearness[dish], FIRST_DISH + dish)
            for dish in self.kitchen.counter.tolist()
        ]

    def free_placements(self) -> list[Option]:
        """The free placements of the pulled-out rack for the category in hand."""
        kitchen = self.kitchen
        assert kitchen.held is not None
        assert kitchen.open_rack is not None
        category = kitchen.dishes.category[kitchen.held]
        nearness = placement_nearness(kitchen.table)[kitchen.open_rack]
        first = FIRST_PLACEMENT[kitchen.open_rack]
        return [
            Option(CATEGORIES[category], nearness[placement], first + placement)
            for placement in kitchen.free(kitchen.open_rack, category).tolist()
        ]

    def fits(self, rack: str, category: str) -> bool:
        """Whether a rack, open or closed, has a free placement for a category."""
        return len(self.kitchen.free(rack, CATEGORIES.index(category))) > 0


@dataclass(frozen=True)
class ExpertTrajectory:
    """The expert's decisions from a start.

    Attributes:
        decisions: The chosen instances.
        kinds: What each of them is, see `kitchen.decision_kind`.
        kitchen: The kitchen as the expert leaves it.
    """

    decisions: tuple[int, ...]
    kinds: tuple[str, ...]
    kitchen: Kitchen


def roll_out_expert(kitchen: Kitchen, preference: Preference) -> ExpertTrajectory:
    """Let the expert finish a kitchen, which it changes.

    Args:
        kitchen: Any reachable state.
        preference: The user's preference.

    Returns:
        Its decisions and the finished kitchen.
    """
    view = KitchenView(kitchen)
    decisions: list[int] = []
    while not kitchen.finished:
        decisions.append(choose(view, preference))
        refusal = kitchen.decide(decisions[-1])
        assert not refusal, f"The expert chose what the kitchen refuses: {refusal}"
    kinds = tuple(decision_kind(instance, kitchen.dishes) for instance in decisions)
    return ExpertTrajectory(tuple(decisions), kinds, kitchen)

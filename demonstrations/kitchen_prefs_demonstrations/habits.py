"""Where a demonstration puts each category and in which order, whatever preference that is.

Unlike `implied_preference` this asks for no three categories in one rack and four in the other: it
is what people are compared by.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.kitchen import FIRST_DISH, IN_RACK, Kitchen, Location
from kitchen_prefs_demonstrations.replaying import ReplayedDemonstration


@dataclass(frozen=True)
class Habit:
    """The racks and ranks of categories in one demonstration.

    Attributes:
        rack_of: The rack in which most dishes of a category stand; none for one that is in no rack.
        rank_of: The rank of a category among those of its rack, by its first dish that went there.
    """

    rack_of: dict[str, str]
    rank_of: dict[str, int]


def habit_of(demonstration: ReplayedDemonstration) -> Habit:
    """Read the habit of a demonstration."""
    standing: dict[str, Counter[str]] = {rack: Counter() for rack in RACKS}
    first: dict[tuple[str, str], int] = {}
    kitchen = Kitchen(demonstration.session.dishes)
    for number, instance in enumerate(demonstration.decisions):
        held, rack = kitchen.held, kitchen.open_rack
        kitchen.decide(instance)
        if held is not None and rack and kitchen.location[held] == IN_RACK[rack]:
            category = category_of(kitchen, held)
            standing[rack][category] += 1
            first.setdefault((rack, category), number)
    known = [c for c in CATEGORIES if any(standing[rack][c] for rack in RACKS)]
    rack_of = {c: max(RACKS, key=lambda rack: standing[rack][c]) for c in known}
    rank_of = {
        category: rank
        for rack in RACKS
        for rank, category in enumerate(
            sorted((c for c in known if rack_of[c] == rack), key=lambda c: first[rack, c])
        )
    }
    return Habit(rack_of, rank_of)


@dataclass(frozen=True)
class Occasion:
    """A decision with nothing in hand and a rack out.

    Attributes:
        rack: The rack that is out.
        waiting: The categories that wait on the counter.
        picked: The category of the dish that is picked; None for the door or a rack.
    """

    rack: str
    waiting: frozenset[str]
    picked: str | None


def occasions_of(demonstration: ReplayedDemonstration) -> list[Occasion]:
    """All such decisions of a demonstration."""
    kitchen = Kitchen(demonstration.session.dishes)
    found = []
    for instance in demonstration.decisions:
        if kitchen.held is None and kitchen.open_rack is not None:
            waiting = frozenset(category_of(kitchen, dish) for dish in kitchen.counter)
            is_dish = instance >= FIRST_DISH
            picked = category_of(kitchen, instance - FIRST_DISH) if is_dish else None
            found.append(Occasion(kitchen.open_rack, waiting, picked))
        kitchen.decide(instance)
    return found


def turns(occasions: Iterable[Occasion], habit: Habit) -> tuple[int, int]:
    """How often the dish whose turn it is by a habit is picked.

    An occasion counts if categories of two ranks or more of the rack that is out wait; it is right
    if one of the lowest rank is picked (`metrics.turn_accuracy`).

    Returns:
        The right occasions and those that count.
    """
    right = counted = 0
    for occasion in occasions:
        ranks = {
            habit.rank_of[category]: category
            for category in occasion.waiting
            if habit.rack_of.get(category) == occasion.rack
        }
        if len(ranks) > 1:
            counted += 1
            right += occasion.picked == ranks[min(ranks)]
    return right, counted


def destinations(demonstration: ReplayedDemonstration) -> Counter[tuple[str, str]]:
    """How many dishes of each category are where at the end.

    Where is one of four zones, which are the halves of the racks, or "in sink" or "left".
    """
    kitchen = demonstration.kitchen
    return Counter(
        (category_of(kitchen, dish), _zone(kitchen, dish)) for dish in range(len(kitchen.location))
    )


def category_of(kitchen: Kitchen, dish: int) -> str:
    """The category of a dish."""
    return CATEGORIES[kitchen.dishes.category[dish]]


def _zone(kitchen: Kitchen, dish: int) -> str:
    for rack in RACKS:
        if kitchen.location[dish] == IN_RACK[rack]:
            side = "left" if kitchen.pose[dish, 0] < layout.RACK_CLOSED[rack][0] else "right"
            return f"in {rack} {side}"
    return "in sink" if kitchen.location[dish] == Location.SINK else "left"

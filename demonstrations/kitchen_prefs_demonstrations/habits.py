"""Where a demonstration puts each category and in which order, whatever preference that is.

Unlike `implied_preference` this asks for no three categories in one rack and four in the other: it
is what people are compared by.
"""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations, permutations

from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.kitchen import FIRST_DISH, IN_RACK, Kitchen, Location
from kitchen_prefs_demonstrations.replaying import ReplayedDemonstration


@dataclass(frozen=True)
class Habit:
    """The racks and ranks of categories in one demonstration.

    Attributes:
        rack_of: The rack in which most dishes of a category stand; none for one that is in no rack.
        rank_of: The rank of a category among those of its rack, in the order that most picks
            follow.
    """

    rack_of: dict[str, str]
    rank_of: dict[str, int]


def habit_of(demonstration: ReplayedDemonstration) -> Habit:
    """Read the habit of a demonstration."""
    standing: Counter[tuple[str, str]] = Counter()  # in order of the first dish
    kitchen = Kitchen(demonstration.session.dishes)
    for instance in demonstration.decisions:
        held, rack = kitchen.held, kitchen.open_rack
        kitchen.decide(instance)
        if held is not None and rack and kitchen.location[held] == IN_RACK[rack]:
            standing[category_of(kitchen, held), rack] += 1
    known = dict.fromkeys(category for category, _ in standing)
    rack_of = {c: max(RACKS, key=lambda rack: standing[c, rack]) for c in known}
    before = picks_before(occasions_of(demonstration), rack_of)
    orders = [_order([c for c in known if rack_of[c] == name], before) for name in RACKS]
    return Habit(rack_of, {c: rank for order in orders for rank, c in enumerate(order)})


def _order(categories: Sequence[str], before: Counter[tuple[str, str]]) -> Sequence[str]:
    """The order that most picks follow (Kemeny's); among equals, that of the first dishes.

    At most seven categories have 5,040 orders.
    """
    return max(
        permutations(categories),
        key=lambda order: sum(before[pair] for pair in combinations(order, 2)),
    )


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


def picks_before(
    occasions: Iterable[Occasion], rack_of: Mapping[str, str]
) -> Counter[tuple[str, str]]:
    """How often one category is picked for the rack that is out while another one waits for it."""
    return Counter(
        (occasion.picked, other)
        for occasion in occasions
        if occasion.picked and rack_of.get(occasion.picked) == occasion.rack
        for other in occasion.waiting - {occasion.picked}
        if rack_of.get(other) == occasion.rack
    )


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

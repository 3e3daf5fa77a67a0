"""A user in words, one canonical description: what to do with any dish, in the order of the rules.

Users who load differently have different descriptions; the same user always has the same one.
"""

from collections.abc import Sequence

from kitchen_prefs.people.attributes import CLASSES, COLOURS, MATERIALS
from kitchen_prefs.people.users import ByClass, Predicate, User
from kitchen_prefs.people.zones import ZONES
from kitchen_prefs.preferences import CATEGORIES, plural

# The dishes of each class of a scheme.
DISHES_OF = {
    "category": tuple(plural(category) for category in CATEGORIES),
    "family": ("cups and glasses", "bowls", "plates", "trays"),
    "material": tuple(f"dishes of {material}" for material in MATERIALS),
    "colour": tuple(f"{colour} dishes" for colour in COLOURS),
    "size": tuple(f"{size} dishes" for size in CLASSES["size"]),
}
WHEN_FULL = {
    "other side, then other rack": "try the other side of its rack, then the other rack, and last "
    "the sink",
    "other rack, then other side": "try the other rack, then the other side of its rack, and last "
    "the sink",
    "sink": "put the dish into the sink",
}
IN_STYLE = {
    "far left corner": "Fill each place from its far left corner.",
    "near right corner": "Fill each place from its near right corner.",
    "beside its family": "Stand each dish beside its family.",
    "apart from its family": "Stand each dish apart from its family.",
}


def user_in_words(user: User) -> str:
    """Describe a user: hand wash, exceptions, base, overflow, order and style, a sentence each."""
    sentences = (
        _hand_wash(user.hand),
        *_exceptions(user),
        _base(user.base, is_rest=bool(user.exceptions)),
        f"When a place is full, {WHEN_FULL[user.overflow]}.",
        _order(user.first, user.order),
        IN_STYLE[user.style],
    )
    return " ".join(sentences)


def dishes_in_words(predicate: Predicate) -> str:
    """The dishes that a predicate is true of, such as "blue cups" or "dishes of wood"."""
    soil = {None: "", True: "greasy ", False: "clean "}[predicate.greasy]
    colour = "" if predicate.colour is None else f"{list(COLOURS)[predicate.colour]} "
    noun = "dishes" if predicate.category is None else plural(CATEGORIES[predicate.category])
    material = "" if predicate.material is None else f" of {MATERIALS[predicate.material]}"
    return f"{soil}{colour}{noun}{material}"


def _hand_wash(hand: Predicate | None) -> str:
    if hand is None:
        return "Wash nothing by hand."
    return f"Wash {dishes_in_words(hand)} by hand: put them into the sink."


def _exceptions(user: User) -> list[str]:
    return [
        f"{'Of the rest, put' if number else 'Put'} {dishes_in_words(exception.predicate)} "
        f"{_place(exception.zone)}, whatever else they are."
        for number, exception in enumerate(user.exceptions)
    ]


def _base(base: ByClass, is_rest: bool) -> str:
    """Which classes go where, zone by zone."""
    loads = []
    for zone in range(len(ZONES)):
        own = [
            dishes
            for dishes, value in zip(DISHES_OF[base.scheme], base.values, strict=True)
            if value == zone
        ]
        if own:
            loads.append(f"{_listed(own)} {_place(zone)}")
    return f"{'Of all others, put' if is_rest else 'Put'} {'; '.join(loads)}."


def _order(first: str, order: ByClass | None) -> str:
    start = f"Load the {first} rack first"
    if order is None:
        return f"{start}, and always take the dish that is nearest to the sink."
    ranked = sorted(zip(order.values, DISHES_OF[order.scheme], strict=True))
    return f"{start}, and in each rack {', then '.join(dishes for _, dishes in ranked)}."


def _place(zone: int) -> str:
    rack, side = ZONES[zone].split()
    return f"on the {side} of the {rack} rack"


def _listed(names: Sequence[str]) -> str:
    """Names as a list, "a, b and c"; their own "and" would blur it, so it has commas alone then."""
    if len(names) == 1 or any(" and " in name for name in names):
        return ", ".join(names)
    return f"{', '.join(names[:-1])} and {names[-1]}"

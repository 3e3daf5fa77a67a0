"""The prior of the grammar: how users are drawn.

`posterior` weighs the same probabilities, so each choice here is one of a few named ones.
"""

from dataclasses import replace
from itertools import product

import numpy as np

from kitchen_prefs.people.attributes import CLASSES, COLOURS, MATERIALS
from kitchen_prefs.people.users import (
    SCHEMES,
    STYLES,
    ByClass,
    Predicate,
    User,
    ZoneException,
    every_exception,
)
from kitchen_prefs.people.zones import OVERFLOWS, RACK_OF_ZONE, ZONES

HAND: dict[Predicate | None, float] = {
    None: 0.40,
    Predicate(material=MATERIALS.index("wood")): 0.27,
    Predicate(material=MATERIALS.index("plastic")): 0.10,
    Predicate(material=MATERIALS.index("glass")): 0.08,
} | {Predicate(colour=colour): 0.15 / len(COLOURS) for colour in range(len(COLOURS))}
EXCEPTIONS = (0.2, 0.5, 0.3)  # none, one, two
# The kinds of exceptions are equally frequent, and so are the predicates of a kind.
EXCEPTION_KINDS = ("material", "colour", "greasy", "category", "category and colour")
SCHEME = {"category": 0.25, "family": 0.3, "material": 0.2, "colour": 0.1, "size": 0.15}
NO_ORDER = 0.2  # the share of users who take what is nearest
LEAST_ZONES = {3: 2, 4: 3, 7: 3}  # how many zones a scheme of so many classes uses at least

# Mugs stand on top in 76 % of homes, plates at the bottom in 75 %; of the rest polls say nothing.
TOP_BY_POLLS = {"mugs": 0.76, "plates": 0.25}
POLLED = {"cup": "mugs", "glass": "mugs", "drink": "mugs"} | dict.fromkeys(
    ("small plate", "big plate", "plate"), "plates"
)

# Pairs that training lacks, and that all users of `people_composed` have: each scheme with a kind
# of exception.
COMPOSED = {
    ("category", "colour"),
    ("family", "greasy"),
    ("material", "category and colour"),
    ("colour", "category"),
    ("size", "material"),
}


def sample_user(generator: np.random.Generator) -> User:
    """Draw a user."""
    scheme = draw(SCHEME, generator)
    exceptions = int(generator.choice(len(EXCEPTIONS), p=EXCEPTIONS))
    return User(
        hand=draw(HAND, generator),
        exceptions=tuple(sample_exception(generator) for _ in range(exceptions)),
        base=ByClass(scheme, sample_zones(scheme, generator)),
        overflow=str(generator.choice(list(OVERFLOWS))),
        first=str(generator.choice(["top", "bottom"])),
        order=None if generator.random() < NO_ORDER else sample_order(generator),
        style=str(generator.choice(STYLES)),
    )


def sample_polled_user(generator: np.random.Generator) -> User:
    """Draw a user whose zones are as polls tell of real homes, where they say something."""
    user = sample_user(generator)
    scheme, classes = user.base.scheme, CLASSES[user.base.scheme]
    if scheme not in ("category", "family"):
        return user
    top = [TOP_BY_POLLS.get(POLLED.get(name, ""), 0.5) for name in classes]
    while True:
        racks = generator.random(len(classes)) >= top  # True for the bottom
        zones = tuple((2 * racks + generator.integers(2, size=len(classes))).tolist())
        if is_base(zones):
            return replace(user, base=ByClass(scheme, zones))


def sample_exception(generator: np.random.Generator) -> ZoneException:
    """Draw an exception."""
    kind = str(generator.choice(EXCEPTION_KINDS))
    predicates = [predicate for predicate in every_exception() if predicate.kind == kind]
    chosen = predicates[int(generator.integers(len(predicates)))]
    return ZoneException(chosen, int(generator.integers(len(ZONES))))


def sample_zones(scheme: str, generator: np.random.Generator) -> tuple[int, ...]:
    """Draw the zone of each class of a scheme: both racks, and not too few zones."""
    while True:
        zones = tuple(generator.integers(len(ZONES), size=len(CLASSES[scheme])).tolist())
        if is_base(zones):
            return zones


def is_base(zones: tuple[int, ...]) -> bool:
    """Whether a user may have these zones for the classes of a scheme."""
    racks = {RACK_OF_ZONE[zone] for zone in zones}
    return len(racks) == 2 and len(set(zones)) >= LEAST_ZONES[len(zones)]


def sample_order(generator: np.random.Generator) -> ByClass:
    """Draw a scheme and the rank of each of its classes."""
    scheme = draw(SCHEME, generator)
    return ByClass(scheme, tuple(generator.permutation(len(CLASSES[scheme])).tolist()))


def pairs_of(user: User) -> set[tuple[str, str]]:
    """The user's pairs of scheme and kind of exception."""
    return set(product([user.base.scheme], {one.predicate.kind for one in user.exceptions}))


def draw[Value](probabilities: dict[Value, float], generator: np.random.Generator) -> Value:
    """Draw a key by its probability."""
    keys = list(probabilities)
    return keys[int(generator.choice(len(keys), p=list(probabilities.values())))]


assert set(SCHEMES) == set(SCHEME)

"""A user of the second tier: where each dish goes, in which order, and how it is placed.

A rule speaks of attributes, so a user is total: any dish has a zone, or is washed by hand.
"""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs.people.attributes import CLASSES, COLOURS, MATERIALS, DescribedDishes
from kitchen_prefs.people.zones import SINK_ZONE
from kitchen_prefs.preferences import CATEGORIES

SCHEMES = tuple(CLASSES)
STYLES = ("far left corner", "near right corner", "beside its family", "apart from its family")


@dataclass(frozen=True)
class Predicate:
    """What a rule says of a dish; None where it says nothing.

    Attributes:
        category: Index into CATEGORIES.
        material: Index into MATERIALS.
        colour: Index into COLOURS.
        greasy: Whether food sticks to it.
    """

    category: int | None = None
    material: int | None = None
    colour: int | None = None
    greasy: bool | None = None

    @property
    def kind(self) -> str:
        """The attributes that it speaks of, such as "category and colour"."""
        return " and ".join(name for name, value in vars(self).items() if value is not None)

    def matches(self, dishes: DescribedDishes) -> np.ndarray:
        """Which dishes it is true of, (n,) bool."""
        true = np.ones(len(dishes.category), dtype=bool)
        for name, value in vars(self).items():
            if value is not None:
                true &= getattr(dishes, name) == value
        return true


def every_exception() -> tuple[Predicate, ...]:
    """All predicates that an exception may have, kind by kind."""
    categories, colours = range(len(CATEGORIES)), range(len(COLOURS))
    return (
        *(Predicate(material=material) for material in range(len(MATERIALS))),
        *(Predicate(colour=colour) for colour in colours),
        Predicate(greasy=True),
        *(Predicate(category=category) for category in categories),
        *(Predicate(category=one, colour=other) for one in categories for other in colours),
    )


@dataclass(frozen=True)
class ZoneException:
    """Dishes that do not go where their class does.

    Attributes:
        predicate: Which dishes.
        zone: Where they go, an index into ZONES.
    """

    predicate: Predicate
    zone: int


@dataclass(frozen=True)
class ByClass:
    """A number for each class of a scheme: a zone, or a rank.

    Attributes:
        scheme: The scheme, see `attributes.CLASSES`.
        values: One a class.
    """

    scheme: str
    values: tuple[int, ...]

    def of(self, dishes: DescribedDishes) -> np.ndarray:
        """The number of each dish, (n,) int."""
        return np.array(self.values)[dishes.classes(self.scheme)]


@dataclass(frozen=True, eq=False)
class LoadingPlan:
    """How the dishes of one session are loaded: what `expert` acts upon.

    Attributes:
        zones: The zone that each dish should go to, (n,) int; SINK_ZONE for one washed by hand.
        ranks: The rank of each dish, (n,) int; the lowest is loaded first.
        first: The rack that is loaded first.
        overflow: What happens when a zone is full, a key of OVERFLOWS.
        style: Where within a zone a dish is placed, one of STYLES.
    """

    zones: np.ndarray
    ranks: np.ndarray
    first: str
    overflow: str
    style: str

    @property
    def racks(self) -> tuple[str, str]:
        """Both racks, in loading order."""
        return (self.first, "top" if self.first == "bottom" else "bottom")


@dataclass(frozen=True)
class User:
    """One user.

    Attributes:
        hand: What is washed by hand; None for nothing.
        exceptions: At most two; the first that matches a dish counts.
        base: The zone of each class of a scheme.
        overflow: What happens when a zone is full, a key of OVERFLOWS.
        first: The rack that is loaded first.
        order: The rank of each class of a scheme; None for a user who takes what is nearest.
        style: Where within a zone a dish is placed, one of STYLES.
    """

    hand: Predicate | None
    exceptions: tuple[ZoneException, ...]
    base: ByClass
    overflow: str
    first: str
    order: ByClass | None
    style: str

    def plan(self, dishes: DescribedDishes) -> LoadingPlan:
        """How the user loads some dishes."""
        return LoadingPlan(
            self.zones(dishes), self.ranks(dishes), self.first, self.overflow, self.style
        )

    def zones(self, dishes: DescribedDishes) -> np.ndarray:
        """The zone that each dish should go to, (n,) int; SINK_ZONE if it is washed by hand."""
        zone = self.base.of(dishes)
        for exception in reversed(self.exceptions):
            zone[exception.predicate.matches(dishes)] = exception.zone
        if self.hand is not None:
            zone[self.hand.matches(dishes)] = SINK_ZONE
        return zone

    def ranks(self, dishes: DescribedDishes) -> np.ndarray:
        """The rank of each dish, (n,) int; the lowest is loaded first, all are 0 without order."""
        if self.order is None:
            return np.zeros(len(dishes.category), dtype=int)
        return self.order.of(dishes)

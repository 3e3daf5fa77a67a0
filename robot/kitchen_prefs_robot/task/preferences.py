"""Preferences about two drawers: which comes first, and what goes where in which order.

A preference is about the two to four categories of its sessions. What must be read from the prompt
is above all how they part; so it is by partitions, in whichever drawers, that training, validation
and test are apart.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, plural
from kitchen_prefs.utils.suggestions import suggest
from kitchen_prefs_robot.task.state import DRAWERS

FEWEST_CATEGORIES, MOST_CATEGORIES = 2, 4  # of four dishes, as the paper's hardware has them
PAPER_CATEGORIES = {"small bowl", "big bowl", "cup", "small plate"}

Partition = tuple[tuple[str, ...], tuple[str, ...]]


@dataclass(frozen=True)
class DrawerPreference:
    """One way to load two drawers.

    Attributes:
        first: The drawer that is loaded first.
        upper: The categories of the upper drawer, in loading order.
        lower: Those of the lower drawer.

    Raises:
        ValueError: If the drawer or a category is unknown, a drawer has no category, or a category
            is named twice.
    """

    first: str
    upper: tuple[str, ...]
    lower: tuple[str, ...]

    def __post_init__(self) -> None:
        if self.first not in DRAWERS:
            raise ValueError(f"There is no drawer {self.first!r}. {suggest(self.first, DRAWERS)}")
        for category in self.categories:
            if category not in CATEGORIES:
                raise ValueError(
                    f"There is no category {category!r}. {suggest(category, CATEGORIES)}"
                )
        if not self.upper or not self.lower:
            raise ValueError("A preference gives each drawer one category or more.")
        if len(set(self.categories)) < len(self.categories):
            raise ValueError(f"A preference names a category once, not as {self.categories} does.")

    @property
    def categories(self) -> tuple[str, ...]:
        """All categories that the preference is about."""
        return self.upper + self.lower

    @property
    def drawers(self) -> tuple[str, str]:
        """Both drawers, in loading order."""
        return DRAWERS if self.first == "upper" else ("lower", "upper")

    def order(self, drawer: str) -> tuple[str, ...]:
        """The categories of a drawer, in loading order."""
        return self.upper if drawer == "upper" else self.lower

    @cached_property
    def drawer_of(self) -> dict[str, str]:
        """The drawer of each category."""
        return {category: drawer for drawer in DRAWERS for category in self.order(drawer)}

    @cached_property
    def rank_of(self) -> dict[str, int]:
        """The place of each category in its drawer's order, from 0."""
        return {c: rank for drawer in DRAWERS for rank, c in enumerate(self.order(drawer))}

    @cached_property
    def in_words(self) -> str:
        """The preference as a sentence."""
        loads = [
            f"the {drawer} drawer with {', then '.join(map(plural, self.order(drawer)))}"
            for drawer in self.drawers
        ]
        return f"Load {loads[0]}; then {loads[1]}."

    def opposite(self) -> "DrawerPreference":
        """The opposite preference: each category in the other drawer."""
        return DrawerPreference(self.first, self.lower, self.upper)


def partitions() -> list[Partition]:
    """All ways to part two to four of the seven categories in two."""
    return [
        (side, tuple(category for category in chosen if category not in side))
        for size in range(FEWEST_CATEGORIES, MOST_CATEGORIES + 1)
        for chosen in combinations(CATEGORIES, size)
        for taken in range(1, size)
        for side in combinations(chosen, taken)
        if chosen[0] in side  # the other side is the same partition
    ]


def _draw(partition: Partition, generator: np.random.Generator) -> DrawerPreference:
    """A preference with a partition: which side is whose, in which orders, and what is first."""
    upper, lower = (
        tuple(generator.permutation(partition[side]).tolist()) for side in generator.permutation(2)
    )
    return DrawerPreference(str(generator.choice(DRAWERS)), upper, lower)


def _all_preferences() -> tuple[DrawerPreference, ...]:
    generator = np.random.default_rng(0)
    shuffled = [partitions()[i] for i in generator.permutation(len(partitions()))]
    shuffled.sort(key=lambda sides: set(sides[0] + sides[1]) != PAPER_CATEGORIES)
    return tuple(_draw(partition, generator) for partition in shuffled)


# One preference for each of the 371 partitions; its number here is its label. Those of the paper's
# dishes come first, so that training sees none of them; the others are in random order.
PREFERENCES = _all_preferences()
LABELS = {
    "test": range(200),
    "val": range(200, 240),
    "train": range(240, len(PREFERENCES)),
}

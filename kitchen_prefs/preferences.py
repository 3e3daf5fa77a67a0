"""Preferences: which rack is loaded first, and which categories go where in which order."""

from dataclasses import dataclass
from functools import cached_property
from itertools import permutations

CATEGORIES = (
    "cup",
    "glass",
    "tray",
    "small bowl",
    "big bowl",
    "small plate",
    "big plate",
)
RACKS = ("bottom", "top")

TOP_CATEGORIES = 3  # the paper's preferences give the top rack three categories, the bottom four
SPACE_SIZE = 2 * 5040  # 2 x 7! (paper, section 3)


@dataclass(frozen=True)
class Preference:
    """One way to load a dishwasher (paper, appendix "Expert Preferences").

    Attributes:
        first: The rack that is loaded first.
        top: Three categories of the top rack, in loading order.
        bottom: The other four categories, those of the bottom rack, in loading order.

    Raises:
        ValueError: If a rack is unknown or the two orders do not name each category once.
    """

    first: str
    top: tuple[str, ...]
    bottom: tuple[str, ...]

    def __post_init__(self) -> None:
        if self.first not in RACKS:
            raise ValueError(f"The first rack is {self.first!r}; it must be one of {RACKS}.")
        if len(self.top) != TOP_CATEGORIES or sorted(self.top + self.bottom) != sorted(CATEGORIES):
            raise ValueError(
                f"A preference names each of {CATEGORIES} once, {TOP_CATEGORIES} of them in the "
                f"top rack; got top={self.top}, bottom={self.bottom}."
            )

    @property
    def racks(self) -> tuple[str, str]:
        """Both racks, in loading order."""
        return (self.first, "top" if self.first == "bottom" else "bottom")

    def order(self, rack: str) -> tuple[str, ...]:
        """The categories of a rack, in loading order."""
        return self.top if rack == "top" else self.bottom

    @cached_property
    def rack_of(self) -> dict[str, str]:
        """The rack of each category."""
        return {category: rack for rack in RACKS for category in self.order(rack)}

    @cached_property
    def rank_of(self) -> dict[str, int]:
        """The place of each category in its rack's order, from 0."""
        return {c: rank for rack in RACKS for rank, c in enumerate(self.order(rack))}

    @cached_property
    def in_words(self) -> str:
        """The preference as a sentence."""
        loads = [
            f"the {rack} rack with {', then '.join(map(plural, self.order(rack)))}"
            for rack in self.racks
        ]
        return f"Load {loads[0]}; then {loads[1]}."


def plural(category: str) -> str:
    """The word for several dishes of a category."""
    return f"{category}{'es' if category.endswith('s') else 's'}"


def preference_from_number(number: int) -> Preference:
    """The preference with a given number in the space of all 2 x 7!.

    Args:
        number: 0 <= number < SPACE_SIZE; the last half loads the top rack first.

    Raises:
        ValueError: If the number lies outside the space.
    """
    if not 0 <= number < SPACE_SIZE:
        raise ValueError(f"Preference {number} does not exist; the space is 0..{SPACE_SIZE - 1}.")
    first, order = divmod(number, SPACE_SIZE // 2)
    categories = _ORDERS[order]
    return Preference(RACKS[first], categories[:TOP_CATEGORIES], categories[TOP_CATEGORIES:])


def preference_number(preference: Preference) -> int:
    """The inverse of `preference_from_number`."""
    order = _ORDERS.index(preference.top + preference.bottom)
    return RACKS.index(preference.first) * (SPACE_SIZE // 2) + order


_ORDERS = tuple(permutations(CATEGORIES))


def _preference(first: str, top: str, bottom: str) -> Preference:
    return Preference(first, tuple(top.split(", ")), tuple(bottom.split(", ")))


# 1-3 are the paper's examples; 1-7 are seen in training, 8-12 are held out. Every category stands
# in each rack in at least two of the seen ones, so none is tied to a rack.
TWELVE = (
    _preference("top", "cup, glass, small bowl", "big plate, small plate, tray, big bowl"),
    _preference("bottom", "cup, glass, small bowl", "big plate, small plate, tray, big bowl"),
    _preference("bottom", "small plate, glass, cup", "big bowl, tray, big plate, small bowl"),
    _preference("top", "tray, big bowl, cup", "glass, small bowl, small plate, big plate"),
    _preference("top", "big plate, cup, small plate", "small bowl, tray, big bowl, glass"),
    _preference("bottom", "big bowl, glass, tray", "small plate, big plate, cup, small bowl"),
    _preference("top", "small plate, big plate, glass", "tray, cup, small bowl, big bowl"),
    _preference("bottom", "small bowl, small plate, tray", "big bowl, glass, big plate, cup"),
    _preference("top", "big plate, tray, small bowl", "cup, big bowl, small plate, glass"),
    _preference("bottom", "big bowl, small plate, small bowl", "big plate, cup, tray, glass"),
    _preference("top", "small bowl, big plate, big bowl", "glass, tray, cup, small plate"),
    _preference("bottom", "glass, big plate, small bowl", "tray, small plate, cup, big bowl"),
)
SEEN = TWELVE[:7]
HELD_OUT = TWELVE[7:]

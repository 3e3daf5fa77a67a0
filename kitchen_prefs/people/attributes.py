"""What a dish of the second tier is beside its category: material, colour, soil and size.

Dishes are drawn without a look at the user, so that counts, order of arrival and poses tell nothing
of the user.
"""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.counter_layout import try_to_lay_counter
from kitchen_prefs.simulation.kitchen import Dishes
from kitchen_prefs.simulation.placements import LARGEST

MATERIALS = ("ceramic", "glass", "plastic", "wood")
COLOURS = {
    "white": (0.94, 0.94, 0.92),
    "blue": (0.20, 0.42, 0.75),
    "red": (0.86, 0.20, 0.15),
    "green": (0.45, 0.62, 0.42),
}

# The materials that a category comes in; each is as frequent as the others.
COMES_IN = {
    "cup": ("ceramic", "glass", "plastic"),
    "glass": ("glass", "plastic"),
    "tray": ("ceramic", "plastic", "wood"),
    "small bowl": MATERIALS,
    "big bowl": MATERIALS,
    "small plate": ("ceramic", "plastic", "wood"),
    "big plate": ("ceramic", "plastic", "wood"),
}
GREASY = 0.3  # the share of dishes
SCALE_DEVIATION = 0.08  # of the logarithm of a dish's scale
LEAST_PRESENT = 0.5  # at least half of the dishes stand there at the start, as in the first tier

EXTENTS = np.array([layout.EXTENTS[category] for category in CATEGORIES])  # (7, 3)
RGB = np.array(list(COLOURS.values()), dtype=np.float32)  # (4, 3)

# In which classes people divide dishes, by the name of the scheme.
FAMILIES = ("drink", "drink", "tray", "bowl", "bowl", "plate", "plate")  # of each category
SIZE_LIMITS = (0.15, 0.20)  # m: the longest side of a small and of a middling dish is shorter
CLASSES = {
    "category": CATEGORIES,
    "family": ("drink", "bowl", "plate", "tray"),
    "material": MATERIALS,
    "colour": tuple(COLOURS),
    "size": ("small", "middling", "large"),
}
FAMILY_OF = np.array([CLASSES["family"].index(family) for family in FAMILIES])  # (7,)


@dataclass(frozen=True, eq=False)
class DescribedDishes(Dishes):
    """The dishes of a session of the second tier, in the order in which they arrive.

    Attributes:
        material: Index into MATERIALS, (n,) int8.
        colour: Index into COLOURS, (n,) int8.
        greasy: Whether food sticks to it, (n,) bool.
        scale: By how much it is larger than its category's extents, (n,) float32.
    """

    material: np.ndarray
    colour: np.ndarray
    greasy: np.ndarray
    scale: np.ndarray

    def digested(self) -> tuple[np.ndarray, ...]:
        """What a kitchen's digest tells of them beside their poses."""
        return (*super().digested(), self.material, self.colour, self.greasy, self.scale)

    @property
    def extents(self) -> np.ndarray:
        """The full extents of each dish when it stands upright, (n, 3) m."""
        return EXTENTS[self.category] * self.scale[:, None]

    def classes(self, scheme: str) -> np.ndarray:
        """The class of each dish in a scheme, (n,) int, an index into `CLASSES[scheme]`."""
        if scheme == "size":
            return np.searchsorted(SIZE_LIMITS, self.extents[:, :2].max(axis=1), side="right")
        if scheme == "family":
            return FAMILY_OF[self.category]
        return getattr(self, scheme).astype(int)


def draw_dishes(
    count: int, generator: np.random.Generator, lacking: tuple[int, ...] = ()
) -> DescribedDishes:
    """Draw the dishes of a session and lay them on the counter.

    Args:
        count: How many, at least one of each category.
        generator: Draws all of it.
        lacking: Categories that do not occur.
    """
    while True:
        dishes = _try_to_draw(count, generator, lacking)
        if dishes is not None:
            return dishes


def _try_to_draw(
    count: int, generator: np.random.Generator, lacking: tuple[int, ...]
) -> DescribedDishes | None:
    """Draw dishes; None where the counter has no room for them."""
    categories = [c for c in range(len(CATEGORIES)) if c not in lacking]
    more = generator.choice(categories, size=count - len(categories))
    category = generator.permutation([*categories, *more]).astype(np.int8)  # (n,)
    material = np.array([_draw_material(CATEGORIES[c], generator) for c in category], np.int8)
    colour = generator.integers(len(COLOURS), size=count).astype(np.int8)
    greasy = generator.random(count) < GREASY
    scale = np.exp(SCALE_DEVIATION * generator.standard_normal(count))
    scale = np.clip(scale, 2 - LARGEST, LARGEST).astype(np.float32)
    pose = try_to_lay_counter(EXTENTS[category] * scale[:, None], generator)
    if pose is None:
        return None
    present = round(generator.uniform(LEAST_PRESENT, 1) * count)
    return DescribedDishes(category, pose, present, material, colour, greasy, scale)


def _draw_material(category: str, generator: np.random.Generator) -> int:
    return MATERIALS.index(str(generator.choice(COMES_IN[category])))

"""The preferences of the human demonstrations: order of the drawers x partition of the dishes."""

from kitchen_prefs_robot.task.preferences import DrawerPreference
from kitchen_prefs_robot.task.state import DRAWERS

# Upper and lower drawer, in loading order: bowls apart and plate with one of them, or one alone.
PARTITIONS = (
    (("big bowl", "small plate"), ("cup", "small bowl")),
    (("big bowl",), ("small plate", "cup", "small bowl")),
)
HUMAN_PREFERENCES = tuple(
    DrawerPreference(first, upper, lower) for upper, lower in PARTITIONS for first in DRAWERS
)


def human_preference(number: int) -> DrawerPreference:
    """One of the four preferences.

    Raises:
        ValueError: If there is none with this number.
    """
    if not 0 <= number < len(HUMAN_PREFERENCES):
        listed = " ".join(f"{i}: {p.in_words}" for i, p in enumerate(HUMAN_PREFERENCES))
        raise ValueError(f"There is no preference {number} to demonstrate. There are {listed}")
    return HUMAN_PREFERENCES[number]

"""What one decision knows: the dishes that are seen, the drawer that is open, the dish in hand."""

from dataclasses import dataclass

DRAWERS = ("upper", "lower")


@dataclass(frozen=True)
class SeenDish:
    """A dish as it is known at one decision, in the kitchen's frame.

    Attributes:
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        position: (x, y, z) of its centre in m.
        quaternion: (w, x, y, z).
        drawer: None on the table, "upper" or "lower" where it has been placed; it then has the
            drop pose.
    """

    category: str
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]
    drawer: str | None


@dataclass(frozen=True)
class DrawersState:
    """What one decision knows.

    Attributes:
        dishes: The dishes, without the one in hand.
        opened: The drawer that is open, or None.
        in_hand: The category of the dish in hand, or None.
    """

    dishes: tuple[SeenDish, ...]
    opened: str | None
    in_hand: str | None

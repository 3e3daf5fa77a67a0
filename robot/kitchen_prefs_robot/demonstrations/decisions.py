"""Which decision a person made between two looks, from what changed."""

import numpy as np

from kitchen_prefs_robot.perception.detection import Detection, Sight
from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, Toggle

STAYED = 0.05  # m between two looks: perception errs by less, and dishes stand farther apart


def decision_between(before: Sight, after: Sight) -> Decision:
    """The decision between two looks.

    The paper's authors segmented their clouds by hand; here the change itself tells: a drawer
    opened or closed, a dish came into the hand, or it left the hand.

    Args:
        before: The look before it.
        after: The look after it.

    Returns:
        The decision; a picked dish has its number among those of the first look that are not in
        hand, as `to_drawers_state` numbers them.

    Raises:
        ValueError: If nothing changed, or more than one decision changes.
    """
    opened, closed = after.opened, before.opened
    held, holds = (any(d.place == "hand" for d in look.dishes) for look in (before, after))
    if opened != closed and held == holds and None in (opened, closed):
        return Toggle(opened or closed or "")
    if opened == closed and holds and not held:
        return Pick(_vanished(before, after))
    if opened == closed and held and not holds and opened is not None:
        return Place(opened)
    raise ValueError(
        "the cameras do not see what one decision changes: a drawer, a dish taken or a dish put "
        "down; show one thing at a time"
    )


def _vanished(before: Sight, after: Sight) -> int:
    """The dish on the counter that is no longer where it was."""
    standing = [found for found in before.dishes if found.place != "hand"]
    left = [found for found in after.dishes if found.place == "counter"]
    ways = [_way_to_nearest(found, left) for found in standing]
    if not ways or max(ways) < STAYED:
        raise ValueError("a dish is in hand, but none has left the table; show it again")
    return int(np.argmax(ways))


def _way_to_nearest(dish: Detection, others: list[Detection]) -> float:
    """How far a dish of the counter stands from the nearest of others, m."""
    if dish.place != "counter":
        return 0.0
    ways = (np.linalg.norm(dish.box.middle - other.box.middle) for other in others)
    return float(min(ways, default=np.inf))

"""The paper's dense reward (appendix "Reward function for GNN-RL")."""

from kitchen_prefs.preferences import CATEGORIES, Preference
from kitchen_prefs.simulation.expert import KitchenView, choose
from kitchen_prefs.simulation.kitchen import (
    FIRST_DISH,
    FIRST_PLACEMENT,
    SINK,
    Kitchen,
    Location,
    decision_kind,
)


def reward(view: KitchenView, preference: Preference, instance: int) -> float:
    """The reward of a decision, computed before the kitchen carries it out.

    It is 1 for picking a dish of the category that the preference calls for now, and for placing a
    dish into a free placement of the rack that the preference gives its category; else 0.

    Args:
        view: The kitchen in which the decision is taken; not finished.
        preference: The user's preference.
        instance: The chosen instance.

    Returns:
        0 or 1.
    """
    kitchen = view.kitchen
    if kitchen.held is not None:
        return float(_fits_preferred_rack(kitchen, preference, instance))
    if instance < FIRST_DISH or kitchen.location[instance - FIRST_DISH] != Location.COUNTER:
        return 0.0
    called_for = decision_kind(choose(view, preference), kitchen.dishes)
    return float(decision_kind(instance, kitchen.dishes) == called_for)


def _fits_preferred_rack(kitchen: Kitchen, preference: Preference, instance: int) -> bool:
    if kitchen.open_rack is None or instance == SINK:
        return False
    category = int(kitchen.dishes.category[kitchen.held])
    placement = instance - FIRST_PLACEMENT[kitchen.open_rack]
    free = (kitchen.free(kitchen.open_rack, category) == placement).any()
    return bool(free) and preference.rack_of[CATEGORIES[category]] == kitchen.open_rack

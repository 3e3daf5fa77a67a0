"""Which of the 2 x 7! preferences a demonstration follows, if any."""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, Preference
from kitchen_prefs.simulation.expert import KitchenView, choose
from kitchen_prefs.simulation.kitchen import FIRST_DISH, IN_RACK, Kitchen, decision_kind
from kitchen_prefs_demonstrations.habits import occasions_of, picks_before
from kitchen_prefs_demonstrations.replaying import ReplayedDemonstration

# Two slips among the 24 or 28 picks and places of a demonstration leave .92 or .93.
LEAST_SHARE = 0.9


@dataclass(frozen=True)
class ImpliedPreference:
    """The preference that the rule `symbolic` reads from a demonstration.

    Attributes:
        preference: The preference.
        share: The share of picks and places that are of the kind that its expert chooses there.
        unseen: The categories of which no dish stands in a rack: their rack is a guess.
        elsewhere: The categories most of whose dishes in racks stand in the other rack.
        ordered: How many of the nine pairs of categories of one rack the demonstration puts into an
            order; the order of the others is a guess.
    """

    preference: Preference
    share: float
    unseen: tuple[str, ...]
    elsewhere: tuple[str, ...]
    ordered: int

    @property
    def is_followed(self) -> bool:
        """Whether the demonstration shows every category and follows the preference."""
        return not self.unseen and not self.elsewhere and self.share >= LEAST_SHARE

    @property
    def why_not(self) -> str:
        """Why it is not followed, in a few words; empty if it is."""
        if self.unseen:
            return f"no {' and no '.join(self.unseen)} stands in a rack"
        if self.elsewhere:
            return f"the nearest one has {' and '.join(self.elsewhere)} in the other rack"
        if not self.is_followed:
            return f"{self.share:.0%} of its picks and places follow one"
        return ""


def implied_preference(demonstration: ReplayedDemonstration) -> ImpliedPreference:
    """Read the preference of a demonstration."""
    from lerobot_policy_kitchen_prefs.rules.preference_inference import symbolic_preference

    preference = symbolic_preference(demonstration.prompt)
    kitchen = demonstration.kitchen
    shown = np.unique(kitchen.dishes.category[kitchen.placement >= 0])
    unseen = tuple(name for i, name in enumerate(CATEGORIES) if i not in shown)
    return ImpliedPreference(
        preference,
        _share(demonstration, preference),
        unseen,
        _elsewhere(kitchen, preference),
        len(_ordered_pairs(demonstration, preference)),
    )


def _elsewhere(kitchen: Kitchen, preference: Preference) -> tuple[str, ...]:
    """The categories most of whose dishes in racks stand in the rack that they should not."""
    found = []
    for i, name in enumerate(CATEGORIES):
        location = kitchen.location[kitchen.dishes.category == i]
        top, bottom = ((location == IN_RACK[rack]).sum() for rack in ("top", "bottom"))
        if (top < bottom) if preference.rack_of[name] == "top" else (bottom < top):
            found.append(name)
    return tuple(found)


def _share(demonstration: ReplayedDemonstration, preference: Preference) -> float:
    dishes = demonstration.session.dishes
    kitchen = Kitchen(dishes)
    view = KitchenView(kitchen)
    same = []
    for instance in demonstration.decisions:
        if instance >= FIRST_DISH:
            kind = decision_kind(choose(view, preference), dishes)
            same.append(kind == decision_kind(instance, dishes))
        kitchen.decide(instance)
    return float(np.mean(same))


def _ordered_pairs(
    demonstration: ReplayedDemonstration, preference: Preference
) -> set[tuple[str, str]]:
    """The pairs of categories of one rack of which the demonstration shows the order.

    One is picked for the rack that is out while the other waits, or a third is between them.
    """
    pairs = set(picks_before(occasions_of(demonstration), preference.rack_of))
    for middle in CATEGORIES:  # Warshall: the order is transitive
        before = [one for one in CATEGORIES if (one, middle) in pairs]
        after = [other for other in CATEGORIES if (middle, other) in pairs]
        pairs |= {(one, other) for one in before for other in after}
    return {(min(pair), max(pair)) for pair in pairs if pair[0] != pair[1]}

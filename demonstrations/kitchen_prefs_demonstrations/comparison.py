"""Two demonstrations of one kitchen, held against each other.

Where  the share of dishes that end in the same zone, like dishes taken together
Turn   how often one picks the dish whose turn it is by the other's order
PE     packing efficiency, with the other's racks as the right ones
ED_c   the edit similarity of categories and racks, with the other's decisions as the expert's
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.metrics import (
    Episode,
    category_edit_similarity,
    packing_efficiency,
    turn_accuracy,
)
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.kitchen import IN_RACK
from kitchen_prefs_demonstrations.habits import (
    Habit,
    Occasion,
    destinations,
    habit_of,
    occasions_of,
    turns,
)
from kitchen_prefs_demonstrations.replaying import ReplayedDemonstration

MEASURES = ("Where", "Turn", "PE", "ED_c")
NO_ACTION = (0.0,) * 7  # people choose instances, not poses; no metric reads the action

Comparison = dict[str, float | None]  # each measure's value, None where no decision counts


@dataclass(frozen=True)
class Traits:
    """What a demonstration is compared by.

    Attributes:
        episode: The facts of the demonstration as an episode.
        destinations: How many dishes of each category are in each zone at the end.
        racked: The dishes of each category in the top and in the bottom rack, (2, 7).
        habit: Its racks and ranks.
        occasions: Where it picks with a rack out.
    """

    episode: Episode
    destinations: Counter[tuple[str, str]]
    racked: np.ndarray
    habit: Habit
    occasions: Sequence[Occasion]


def traits_of(demonstration: ReplayedDemonstration) -> Traits:
    """Compute what a demonstration is compared by."""
    simulator = EpisodeSimulator(demonstration.session)
    for instance in demonstration.decisions:
        simulator.decide(instance, NO_ACTION)
    kitchen = demonstration.kitchen
    standing = (kitchen.dishes.category[kitchen.location == IN_RACK[r]] for r in ("top", "bottom"))
    return Traits(
        episode=simulator.episode(),
        destinations=destinations(demonstration),
        racked=np.stack([np.bincount(dishes, minlength=len(CATEGORIES)) for dishes in standing]),
        habit=habit_of(demonstration),
        occasions=occasions_of(demonstration),
    )


def compare(one: Traits, other: Traits) -> Comparison:
    """Compare two demonstrations of one kitchen; each measure is the mean of both directions."""
    episodes = (episode_against(one, other), episode_against(other, one))
    both_turns = [turn for turn in map(turn_accuracy, episodes) if turn is not None]
    return {
        "Where": where(one, other),
        "Turn": float(np.mean(both_turns)) if both_turns else None,
        "PE": float(np.mean([packing_efficiency(episode) for episode in episodes])),
        "ED_c": float(np.mean([category_edit_similarity(episode) for episode in episodes])),
    }


def where(one: Traits, other: Traits) -> float:
    """The share of dishes that end in the same zone: sum of min over categories and zones, over n.

    A dish that is left on the counter agrees with one that is left there, too.
    """
    return (one.destinations & other.destinations).total() / one.destinations.total()


def episode_against(one: Traits, other: Traits) -> Episode:
    """The episode of a demonstration in which another one takes the place of the expert."""
    top, bottom = np.minimum(one.racked, other.racked).sum(axis=1).tolist()
    other_top, other_bottom = other.racked.sum(axis=1).tolist()
    return replace(
        one.episode,
        expert_decisions=other.episode.decisions,
        expert_kinds=other.episode.kinds,
        placed=(top, bottom),
        expert_placed=(other_top, other_bottom),
        turns=turns(one.occasions, other.habit),
    )

"""How well an episode went: the paper's metrics and this benchmark's score.

Every metric is a function of one `Episode` and needs nothing else. In the formulas, a dishes stand
in the top rack at the end of the expert's episode and b in the bottom, â and b̂ at the end of the
policy's; l and p are the expert's and the policy's numbers of decisions.
"""

from collections.abc import Callable

import numpy as np
import textdistance

from kitchen_prefs.metrics.episode import Episode


def packing_efficiency(episode: Episode) -> float:
    """PE = mean over the racks of â / max(â, a); a rack that both leave empty counts 1.

    The paper's PE (section 4). Order does not matter to it; a dish in the wrong rack does.
    """
    shares = [
        policy / max(policy, expert) if max(policy, expert) else 1.0
        for policy, expert in zip(episode.placed, episode.expert_placed, strict=True)
    ]
    return sum(shares) / len(shares)


def edit_similarity(episode: Episode) -> float:
    """ED = 1 - Levenshtein(decisions, expert's decisions) / l, over the instances chosen.

    The paper's inverse edit distance. It is negative where p is much greater than l.
    """
    return _similarity(episode.decisions, episode.expert_decisions)


def category_edit_similarity(episode: Episode) -> float:
    """ED_c: `edit_similarity` over categories and racks, which forgives swapping two like cups."""
    return _similarity(episode.kinds, episode.expert_kinds)


def _similarity(sequence: tuple, expert: tuple) -> float:
    return 1.0 - textdistance.levenshtein(sequence, expert) / len(expert)


def temporal_efficiency(episode: Episode) -> float:
    """TE = PE · l / max(p, l) (paper, appendix): what looping costs."""
    expert = len(episode.expert_decisions)
    return packing_efficiency(episode) * (expert / max(len(episode.decisions), expert))


def score(episode: Episode) -> float:
    """The mean of PE and ED_c clipped to [0, 1]: a preference is where AND in which order."""
    order = min(max(category_edit_similarity(episode), 0.0), 1.0)
    return (packing_efficiency(episode) + order) / 2


def success(episode: Episode) -> bool:
    """Whether PE is 1, nothing is left on the counter and everything is closed.

    LeRobot's `is_success`. Without `finished` an episode that shuts the door on what the expert
    drops in the sink would count.
    """
    return packing_efficiency(episode) == 1.0 and episode.closed and episode.finished


def category_accuracy(episode: Episode) -> float:
    """How often the policy chooses an instance of the expert's category on the expert's states.

    The paper's category-token accuracy (appendix).

    Args:
        episode: An episode that was rolled out on the expert's states: decision t of the policy and
            of the expert were taken in one state.
    """
    pairs = zip(episode.kinds, episode.expert_kinds, strict=True)
    return float(np.mean([kind == expert for kind, expert in pairs]))


Metric = Callable[[Episode], float]

METRICS: dict[str, Metric] = {
    "Score": score,
    "PE": packing_efficiency,
    "ED": edit_similarity,
    "ED_c": category_edit_similarity,
    "TE": temporal_efficiency,
    "Success": success,
}

# A failed grasp may be tried again, as the noisy split invites to; the third time it is a loop.
LOOP = 3


def failure_modes(episode: Episode) -> dict[str, int]:
    """Why an episode fell short, each with how often it happened; all 0 if nothing went wrong."""
    return {
        "wrong rack": episode.wrong_rack,
        "sunk without need": max(episode.sunk - episode.expert_sunk, 0),
        "looped on a forbidden decision": int(episode.longest_loop >= LOOP),
        "closed early": episode.closed_early,
        "blocked place": episode.blocked_places,
        "ran out of decisions": int(not episode.finished),
    }

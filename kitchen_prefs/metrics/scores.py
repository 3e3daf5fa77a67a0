"""The paper's metrics, this benchmark's Score, and further metrics that explain it.

Every metric is a function of one `Episode`; the rescaled Score also reads the committed Scores of
floor and ceiling (reference_scores.json). In the formulas, a and b are the numbers of correctly
placed dishes in the top and bottom rack at the end of the expert's episode, â and b̂ at the end of
the policy's; l and p are the
expert's and the policy's numbers of decisions.
"""

from collections.abc import Callable, Iterable

import numpy as np
import textdistance

from kitchen_prefs.metrics.episode import Episode
from kitchen_prefs.metrics.references import reference_scores, rescaled


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


def turn_accuracy(episode: Episode) -> float | None:
    """How often the dish whose turn it is was picked, where dishes of several ranks waited.

    A decision counts if nothing is in hand, a rack is out, dishes of at least two categories that
    the preference gives to this rack wait on the counter, and the kitchen carries the decision out.
    It is right if it picks a dish of the category of the lowest rank among them; another dish, or
    closing the rack, is wrong. Refused decisions and failed grasps change nothing and do not count.

    Returns:
        A share, or None if no decision of the episode counts.
    """
    right, turns = episode.turns
    return right / turns if turns else None


def refused_decisions(episode: Episode) -> int:
    """How many decisions the kitchen could not carry out."""
    return sum(episode.refused)


def category_edit_similarity_without_refused(episode: Episode) -> float:
    """ED_c of the decisions that the kitchen carried out: the order without errors of geometry."""
    pairs = zip(episode.kinds, episode.refused, strict=True)
    carried_out = tuple(kind for kind, was_refused in pairs if not was_refused)
    return _similarity(carried_out, episode.expert_kinds)


def rescaled_score(episode: Episode) -> float | None:
    """(Score - floor) / (ceiling - floor) of the episode's split, clipped at neither end.

    Returns:
        None where the split has no committed floor and ceiling.
    """
    if episode.split not in reference_scores():
        return None
    return rescaled(score(episode), reference_scores()[episode.split])


# None means that an episode has no value; it is left out of means.
Metric = Callable[[Episode], float | None]

# The six metrics that every table shows.
METRICS: dict[str, Metric] = {
    "Score": score,
    "PE": packing_efficiency,
    "ED": edit_similarity,
    "ED_c": category_edit_similarity,
    "TE": temporal_efficiency,
    "Success": success,
}
# Shown in files, on the leaderboard's page and in separate tables.
FURTHER_METRICS: dict[str, Metric] = {
    "Rescaled": rescaled_score,
    "Turn": turn_accuracy,
    "Refused": refused_decisions,
    "ED_c without refused": category_edit_similarity_without_refused,
}
ALL_METRICS = METRICS | FURTHER_METRICS

# A failed grasp may be retried, as the noisy split requires; the third time in a row is a loop.
LOOP = 3


def failure_modes(episode: Episode) -> dict[str, int]:
    """How often each failure mode occurred in an episode; all 0 if nothing went wrong."""
    return {
        "wrong rack": episode.wrong_rack,
        "sunk without need": max(episode.sunk - episode.expert_sunk, 0),
        "looped on a forbidden decision": int(episode.longest_loop >= LOOP),
        "closed early": episode.closed_early,
        "blocked place": episode.blocked_places,
        "ran out of decisions": int(not episode.finished),
    }


def count_failure_modes(of_episodes: Iterable[dict[str, int]]) -> dict[str, tuple[int, int]]:
    """For each failure mode, in how many episodes it occurred and how often in all."""
    times: dict[str, list[int]] = {}
    for of_episode in of_episodes:
        for mode, count in of_episode.items():
            times.setdefault(mode, []).append(count)
    return {mode: (sum(n > 0 for n in counts), sum(counts)) for mode, counts in times.items()}

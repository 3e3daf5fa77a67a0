"""How well an episode went: the paper's metrics, this benchmark's score, and their intervals.

Every metric is a function of one `Episode` and needs nothing else, so it can be computed again from
the lines that `records.py` keeps. In the formulas, a dishes stand in the top rack at the end of the
expert's episode and b in the bottom, â and b̂ at the end of the policy's; l and p are the expert's
and the policy's numbers of decisions.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import textdistance


@dataclass(frozen=True)
class Episode:
    """The facts of one finished episode and of the expert's episode from the same start.

    Attributes:
        split: The split's name.
        session: The session's index within the split.
        salt: Which drawing of the split's sessions; 0 is the published one.
        preference: The label of the session's preference, which the expert follows.
        count: The dishes wanted per rack.
        decisions: The instances that the policy chose: 0 the door, 1 the bottom rack, 2 the top
            rack, 3 + i dish i, 999 the sink, 1000 + k placement k of the bottom rack, 2000 + k of
            the top rack.
        kinds: What each of `decisions` is: "door", "bottom rack", "top rack", the category of a
            dish, "in bottom", "in top" or "in sink".
        expert_decisions: The expert's decisions.
        expert_kinds: What each of `expert_decisions` is.
        placed: The dishes in the rack that the preference gives their category: (â, b̂).
        expert_placed: The same for the expert: (a, b).
        wrong_rack: The dishes that stand in the other rack.
        sunk: The dishes dropped in the sink.
        expert_sunk: The dishes that the expert dropped in the sink.
        forbidden: For each of `decisions`, whether the kitchen could not carry it out.
        blocked_places: How often a dish was to go where another one stands in its way.
        longest_loop: The length of the longest run of one and the same forbidden choice.
        closed_early: How often the door was closed with dishes on the counter or still to come.
        closed: Whether both racks were in and the door closed at the end.
        finished: Whether the episode ended by itself, not at the limit of decisions.
        actions: The actions given, 7 numbers (a pose) each.

    Raises:
        ValueError: If there is no expert to compare with, or if the lengths do not agree.
    """

    split: str
    session: int
    salt: int
    preference: int
    count: int
    decisions: tuple[int, ...]
    kinds: tuple[str, ...]
    expert_decisions: tuple[int, ...]
    expert_kinds: tuple[str, ...]
    placed: tuple[int, int]
    expert_placed: tuple[int, int]
    wrong_rack: int
    sunk: int
    expert_sunk: int
    forbidden: tuple[bool, ...]
    blocked_places: int
    longest_loop: int
    closed_early: int
    closed: bool
    finished: bool
    actions: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        where = f"session {self.session} of {self.split}"
        if not self.expert_decisions:
            raise ValueError(f"The expert decides nothing in {where}; there is nothing to compare.")
        of_policy = {len(self.decisions), len(self.kinds), len(self.forbidden), len(self.actions)}
        if len(of_policy) > 1 or len(self.expert_decisions) != len(self.expert_kinds):
            raise ValueError(f"The decisions of {where} and what is said of them differ in length.")


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


def shortcomings(episode: Episode) -> dict[str, int]:
    """Why an episode fell short, each with how often it happened; all 0 if nothing went wrong."""
    return {
        "wrong rack": episode.wrong_rack,
        "sunk without need": max(episode.sunk - episode.expert_sunk, 0),
        "looped on a forbidden decision": int(episode.longest_loop >= LOOP),
        "closed early": episode.closed_early,
        "blocked place": episode.blocked_places,
        "ran out of decisions": int(not episode.finished),
    }


@dataclass(frozen=True)
class Interval:
    """A mean and its 95 % bootstrap interval."""

    mean: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.mean:.3f} [{self.low:.3f}, {self.high:.3f}]"


def summarise(episodes: Sequence[Episode], metric: Metric) -> Interval:
    """The mean of a metric over the episodes of one split.

    Raises:
        ValueError: If there are no episodes.
    """
    return _bootstrap(episodes, [metric(episode) for episode in episodes])


def prompt_use(episodes: Sequence[Episode], swapped: Sequence[Episode]) -> Interval:
    """PE with the right prompt minus PE with another preference's prompt, session by session.

    A policy that ignores its prompt has 0.

    Args:
        episodes: Episodes with the right prompt.
        swapped: The same sessions with another preference's prompt, in any order.

    Raises:
        ValueError: If the two are not the same sessions.
    """
    other = {(e.split, e.salt, e.session): packing_efficiency(e) for e in swapped}
    if other.keys() != {(e.split, e.salt, e.session) for e in episodes}:
        raise ValueError("Prompt use compares the same sessions; evaluate both on all of them.")
    gains = [packing_efficiency(e) - other[e.split, e.salt, e.session] for e in episodes]
    return _bootstrap(episodes, gains)


def mean_of_splits(splits: Sequence[Sequence[Episode]], metric: Metric) -> Interval:
    """The mean of a metric over several splits, each of which counts the same.

    Args:
        splits: The episodes of each split.
        metric: What is averaged, first over the episodes of a split, then over the splits.

    Raises:
        ValueError: If there are no splits, or if one has no episodes.
    """
    if not splits:
        raise ValueError("There are no splits to average over.")
    generator = np.random.default_rng(0)  # one for all: splits are resampled independently
    values = [[metric(episode) for episode in episodes] for episodes in splits]
    means = [
        _resample(episodes, of_split, generator)
        for episodes, of_split in zip(splits, values, strict=True)
    ]
    return _interval(float(np.mean([np.mean(of_split) for of_split in values])), np.mean(means, 0))


RESAMPLES = 10_000  # the interval's ends then move by less than .002 from seed to seed


def _bootstrap(episodes: Sequence[Episode], values: Iterable[float]) -> Interval:
    """The mean of the episodes' values and its interval."""
    values = list(values)
    means = _resample(episodes, values, np.random.default_rng(0))
    return _interval(float(np.mean(values)), means)


def _interval(mean: float, resampled: np.ndarray) -> Interval:
    low, high = np.quantile(resampled, (0.025, 0.975))
    return Interval(mean, float(low), float(high))


def _resample(
    episodes: Sequence[Episode], values: Iterable[float], generator: np.random.Generator
) -> np.ndarray:
    """Resample sessions within preferences; where preferences are a sample, resample those.

    The twelve preferences are fixed, so an interval says what other sessions of them would give.
    Those of many_preferences stand for all that there are. A preference with a single session
    cannot be resampled within, so then the preferences are resampled, too.

    Returns:
        The means of the resampled values, (RESAMPLES,).
    """
    if not episodes:
        raise ValueError("There are no episodes to summarise.")
    of_preference: dict[int, list[float]] = {}
    for episode, value in zip(episodes, values, strict=True):
        of_preference.setdefault(episode.preference, []).append(value)
    groups = [np.array(group, dtype=float) for group in of_preference.values()]

    if episodes[0].split == "many_preferences" or min(map(len, groups)) == 1:
        return _resample_groups(groups, generator)
    return _resample_within(groups, generator)


def _resample_within(groups: list[np.ndarray], generator: np.random.Generator) -> np.ndarray:
    """Means of samples that draw as many values from each group as it has, (RESAMPLES,)."""
    sums = sum(generator.choice(group, (RESAMPLES, len(group))).sum(axis=1) for group in groups)
    return sums / sum(map(len, groups))


def _resample_groups(groups: list[np.ndarray], generator: np.random.Generator) -> np.ndarray:
    """Means of samples that draw whole groups, as many as there are, (RESAMPLES,)."""
    drawn = generator.integers(len(groups), size=(RESAMPLES, len(groups)))
    sums = np.array([group.sum() for group in groups])[drawn].sum(axis=1)
    sizes = np.array([len(group) for group in groups])[drawn].sum(axis=1)
    return sums / sizes

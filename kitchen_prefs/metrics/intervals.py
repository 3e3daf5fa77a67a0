"""Means over episodes with 95 % bootstrap intervals."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from kitchen_prefs.metrics.episode import Episode
from kitchen_prefs.metrics.scores import Metric, packing_efficiency


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

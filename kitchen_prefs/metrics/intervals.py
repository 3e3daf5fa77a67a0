"""Means over episodes with 95 % intervals: the bootstrap's, and Wilson's for success."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import ceil, floor
from typing import Protocol, Self

import numpy as np

from kitchen_prefs.metrics.episode import Episode
from kitchen_prefs.metrics.scores import ALL_METRICS, Metric, packing_efficiency, success

DIGITS = 4  # three are significant, given the bootstrap; a fourth avoids rounding errors in them


@dataclass(frozen=True)
class Interval:
    """A mean and its 95 % interval."""

    mean: float
    low: float
    high: float

    def __str__(self) -> str:
        return f"{self.mean:.3f} [{self.low:.3f}, {self.high:.3f}]"

    def rounded(self) -> Self:
        """The interval as files hold it."""
        return replace(
            self,
            mean=round(self.mean, DIGITS),
            low=round(self.low, DIGITS),
            high=round(self.high, DIGITS),
        )


class Grouped(Protocol):
    """An episode of either tier, as far as resampling knows it."""

    @property
    def split(self) -> str:
        """The split's name."""

    @property
    def preference(self) -> int:
        """Whose episodes are resampled together."""


def summarise(episodes: Sequence[Episode], metric: Metric) -> Interval:
    """The mean of a metric over the episodes of one split that have a value of it.

    Raises:
        ValueError: If no episode has one.
    """
    return _bootstrap(*_with_values(episodes, metric))


def summarise_all(episodes: Sequence[Episode]) -> dict[str, Interval]:
    """The mean of every metric of which at least one episode has a value."""
    return {
        name: summarise(episodes, metric)
        for name, metric in ALL_METRICS.items()
        if _has_values(episodes, metric)
    }


def wilson_success(episodes: Sequence[Episode]) -> Interval:
    """The share of episodes that succeed and its 95 % Wilson interval.

    LeRobot's `pc_success_ci95`. Unlike the bootstrap's it has a width where all episodes succeed.

    Raises:
        ValueError: If there are no episodes.
    """
    return wilson(sum(map(success, episodes)), len(episodes))


def wilson(successes: int, trials: int) -> Interval:
    """The share of trials that succeed and its 95 % Wilson interval (Wilson, 1927).

    Raises:
        ValueError: If there are no trials.
    """
    from scipy.stats import binomtest  # takes half a second to import

    if not trials:
        raise ValueError("There are no episodes to summarise.")
    test = binomtest(successes, trials)
    low, high = test.proportion_ci(method="wilson")
    return Interval(test.statistic, float(low), float(high))


def mean_of_groups(groups: Sequence[Sequence[float]]) -> Interval:
    """The mean of values that come in groups, with the interval of resampling whole groups.

    The values of a group, such as the episodes of one scene, are not independent. Where all groups
    have one mean, resampling has no width; the interval is then Wilson's over the groups.

    Args:
        groups: The values of each group, from 0 to 1.

    Raises:
        ValueError: If there are no groups.
    """
    if not groups:
        raise ValueError("There are no episodes to summarise.")
    values = [np.array(group, dtype=float) for group in groups]
    mean, count = float(np.concatenate(values).mean()), len(groups)
    if np.allclose([group.mean() for group in values], mean):
        successes = round(mean * count, DIGITS)  # a whole number of groups, or between two
        low, high = wilson(floor(successes), count).low, wilson(ceil(successes), count).high
        return Interval(mean, low, high)
    return interval_of(mean, _resample_groups(values, np.random.default_rng(0)))


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


def mean_of_splits[E: Grouped](
    splits: Sequence[Sequence[E]], metric: Callable[[E], float | None]
) -> Interval:
    """The mean of a metric over several splits, each of which counts the same.

    Args:
        splits: The episodes of each split.
        metric: What is averaged, first over the episodes of a split, then over the splits.

    Raises:
        ValueError: If there are no splits, or if no episode of one has a value.
    """
    if not splits:
        raise ValueError("There are no splits to average over.")
    generator = np.random.default_rng(0)  # one for all: splits are resampled independently
    of_splits = [_with_values(episodes, metric) for episodes in splits]
    means = [_resample(episodes, values, generator) for episodes, values in of_splits]
    mean = float(np.mean([np.mean(values) for _, values in of_splits]))
    return interval_of(mean, np.mean(means, axis=0))


def mean_of_splits_all(splits: Sequence[Sequence[Episode]]) -> dict[str, Interval]:
    """The mean over splits of every metric of which each split has a value."""
    return {
        name: mean_of_splits(splits, metric)
        for name, metric in ALL_METRICS.items()
        if all(_has_values(episodes, metric) for episodes in splits)
    }


def _has_values(episodes: Sequence[Episode], metric: Metric) -> bool:
    return any(metric(episode) is not None for episode in episodes)


def _with_values[E: Grouped](
    episodes: Sequence[E], metric: Callable[[E], float | None]
) -> tuple[list[E], list[float]]:
    """The episodes that have a value of a metric, and the values."""
    pairs = [(episode, metric(episode)) for episode in episodes]
    known = [(episode, float(value)) for episode, value in pairs if value is not None]
    return [episode for episode, _ in known], [value for _, value in known]


RESAMPLES = 10_000  # the interval's ends then move by less than .002 from seed to seed


def _bootstrap(episodes: Sequence[Grouped], values: Sequence[float]) -> Interval:
    """The mean of the episodes' values and its interval."""
    means = _resample(episodes, values, np.random.default_rng(0))
    return interval_of(float(np.mean(values)), means)


def interval_of(mean: float, resampled: np.ndarray) -> Interval:
    """A mean and the 95 % interval of its values in resamples, (R,)."""
    low, high = np.quantile(resampled, (0.025, 0.975))
    return Interval(mean, float(low), float(high))


def _resample(
    episodes: Sequence[Grouped], values: Sequence[float], generator: np.random.Generator
) -> np.ndarray:
    """Resample sessions within preferences; where preferences are a sample, resample those.

    The twelve preferences are fixed, so an interval covers other sessions of the same preferences.
    Those of many_preferences are a sample of all preferences. A preference with a single session
    cannot be resampled within, so then the preferences are resampled instead. Of a single one, as
    that of a given prompt, the sessions are resampled.

    Returns:
        The means of the resampled values, (RESAMPLES,).
    """
    if not episodes:
        raise ValueError("There are no episodes to summarise.")
    of_preference: dict[int, list[float]] = {}
    for episode, value in zip(episodes, values, strict=True):
        of_preference.setdefault(episode.preference, []).append(value)
    groups = [np.array(group, dtype=float) for group in of_preference.values()]

    of_a_sample = episodes[0].split == "many_preferences" or min(map(len, groups)) == 1
    if of_a_sample and len(groups) > 1:
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

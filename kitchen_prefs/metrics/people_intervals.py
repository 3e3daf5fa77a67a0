"""Means over episodes of the second tier with 95 % intervals, the bootstrap's over sessions.

Every session of a test split is of another user, so an interval covers other users, too.
"""

from collections.abc import Sequence

import numpy as np

from kitchen_prefs.metrics.intervals import RESAMPLES, Interval
from kitchen_prefs.metrics.people_episode import PEOPLE_METRICS, PeopleEpisode

HEADLINE = "H"


def summarise_people(episodes: Sequence[PeopleEpisode]) -> dict[str, Interval]:
    """H = (Where + Turn) / 2 and the mean of every metric of which an episode has a value.

    Raises:
        ValueError: If there are no episodes.
    """
    if not episodes:
        raise ValueError("There are no episodes to summarise.")
    generator = np.random.default_rng(0)
    times = generator.multinomial(len(episodes), [1 / len(episodes)] * len(episodes), RESAMPLES)
    values = {
        name: np.array([metric(episode) for episode in episodes], dtype=float)  # None is NaN
        for name, metric in PEOPLE_METRICS.items()
    }
    means = {
        name: (np.nanmean(own), _resampled(own, times))
        for name, own in values.items()
        if not np.isnan(own).all()
    }
    if "Turn" in means:
        both = [means["Where"], means["Turn"]]
        means = {HEADLINE: tuple(sum(part) / 2 for part in zip(*both, strict=True)), **means}
    return {name: _interval(float(mean), drawn) for name, (mean, drawn) in means.items()}


def _resampled(values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The mean of the values that are known in each resample, (R,), from (n,) and (R, n)."""
    known = ~np.isnan(values)
    weights = times[:, known]
    return weights @ values[known] / np.maximum(weights.sum(axis=1), 1)


def _interval(mean: float, drawn: np.ndarray) -> Interval:
    low, high = np.quantile(drawn, (0.025, 0.975))
    return Interval(mean, float(low), float(high))

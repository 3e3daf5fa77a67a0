"""Means over episodes of the second tier with 95 % intervals, the bootstrap's over sessions.

Every session of a test split is of another user, so an interval covers other users, too.
"""

from collections.abc import Sequence

import numpy as np

from kitchen_prefs.metrics.intervals import RESAMPLES, Interval, interval_of
from kitchen_prefs.metrics.people_episode import PEOPLE_METRICS, PeopleEpisode, turn, where
from kitchen_prefs.metrics.references import people_reference_scores, rescaled

HEADLINE = "H"
RESCALED = "Rescaled"


def summarise_people(episodes: Sequence[PeopleEpisode]) -> dict[str, Interval]:
    """H = (Where + Turn) / 2, its rescaled value, and the mean of every metric of a split.

    A metric of which no episode has a value is left out; in H, Turn then counts 0. H is rescaled
    where the split has a committed floor and ceiling.

    Raises:
        ValueError: If there are no episodes.
    """
    return _intervals(_means(episodes, np.random.default_rng(0)))


def mean_of_people_splits(splits: Sequence[Sequence[PeopleEpisode]]) -> dict[str, Interval]:
    """The mean over splits, each of which counts the same, of every metric that all of them have.

    Raises:
        ValueError: If there are no splits, or if one has no episodes.
    """
    if not splits:
        raise ValueError("There are no splits to average over.")
    generator = np.random.default_rng(0)  # one for all: splits are resampled independently
    of_splits = [_means(episodes, generator) for episodes in splits]
    shared = [name for name in of_splits[0] if all(name in means for means in of_splits)]
    return _intervals({name: np.mean([own[name] for own in of_splits], axis=0) for name in shared})


def session_headlines(episodes: Sequence[PeopleEpisode]) -> list[float]:
    """What each session of a split contributes to the rescaled H, or to H without references.

    Turn has no value in some sessions, so H is no mean over sessions. These contributions are such
    that their mean is H, and that they vary as H does when sessions are resampled.
    """
    where_and_turn = [np.array([m(e) for e in episodes], dtype=float) for m in (where, turn)]
    both = np.mean([_contributions(own) for own in where_and_turn], axis=0)  # (n,)
    references = people_reference_scores().get(episodes[0].split)
    return [rescaled(own, references) if references else own for own in both.tolist()]


def _contributions(values: np.ndarray) -> np.ndarray:
    """Contributions to the mean of the values that are known, (n,) from (n,); 0 if none is."""
    known = ~np.isnan(values)
    if not known.any():
        return np.zeros(len(values))
    mean = values[known].mean()
    return mean + np.where(known, values - mean, 0.0) / known.mean()


def _intervals(means: dict[str, np.ndarray]) -> dict[str, Interval]:
    return {name: interval_of(float(mean[0]), mean[1:]) for name, mean in means.items()}


def _means(
    episodes: Sequence[PeopleEpisode], generator: np.random.Generator
) -> dict[str, np.ndarray]:
    """Each metric's mean over the episodes, and over each of R resamples, (1 + R,)."""
    if not episodes:
        raise ValueError("There are no episodes to summarise.")
    n = len(episodes)
    times = np.vstack([np.ones(n, int), generator.multinomial(n, [1 / n] * n, RESAMPLES)])
    values = {
        name: np.array([metric(episode) for episode in episodes], dtype=float)  # None is NaN
        for name, metric in PEOPLE_METRICS.items()
    }
    means = {
        name: _mean_of_known(own, times) for name, own in values.items() if not np.isnan(own).all()
    }
    h = (means["Where"] + means.get("Turn", 0.0)) / 2  # (1 + R,)
    references = people_reference_scores().get(episodes[0].split)
    rescaled_h = {RESCALED: rescaled(h, references)} if references else {}
    return {HEADLINE: h, **rescaled_h, **means}


def _mean_of_known(values: np.ndarray, times: np.ndarray) -> np.ndarray:
    """The mean of the values that are known in each resample, (R,), from (n,) and (R, n)."""
    known = ~np.isnan(values)
    weights = times[:, known]
    return weights @ values[known] / np.maximum(weights.sum(axis=1), 1)

"""How far users agree with themselves and with each other: the ceiling of such a benchmark.

Two demonstrations of one kitchen are compared directly, without a preference in between: each in
turn takes the place of the expert, and both directions are averaged. No policy that reads one
demonstration of a user can be expected to agree with the next one better than the user does.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from kitchen_prefs.metrics import Interval
from kitchen_prefs.metrics.intervals import RESAMPLES
from kitchen_prefs_demonstrations.comparison import MEASURES, Comparison, compare, traits_of
from kitchen_prefs_demonstrations.replaying import ReplayedDemonstration


@dataclass(frozen=True)
class Agreement:
    """The agreement of users with themselves and with others.

    Attributes:
        users: How many users there are.
        pairs: How many pairs of demonstrations each figure rests on: "self" and "others".
        measures: For each of "self" and "others", the mean over users, or over pairs of users, of
            each measure, with a 95 % interval over users; a measure without a value is left out.
    """

    users: int
    pairs: dict[str, int]
    measures: dict[str, dict[str, Interval]]


def agreement(demonstrations: Sequence[ReplayedDemonstration]) -> Agreement:
    """Compare all demonstrations of the same kitchen.

    Args:
        demonstrations: Of several users, each with a name or a participant's code.

    Raises:
        ValueError: If one names no user, if two are of one participant's same day, or if no two are
            of the same kitchen.
    """
    users = _numbered_users(demonstrations)
    _check_days(demonstrations)
    traits = [traits_of(demonstration) for demonstration in demonstrations]
    compared: dict[tuple[int, int], list[Comparison]] = {}
    for (one, mine), (other, yours) in combinations(zip(demonstrations, traits, strict=True), 2):
        if _kitchen(one) == _kitchen(other):
            first, second = sorted((users[str(one.file.who)], users[str(other.file.who)]))
            compared.setdefault((first, second), []).append(compare(mine, yours))
    if not compared:
        raise ValueError(
            "No two demonstrations start in the same kitchen; in a study everybody loads one twice."
        )
    selves = {pair: found for pair, found in compared.items() if pair[0] == pair[1]}
    others = {pair: found for pair, found in compared.items() if pair[0] != pair[1]}
    groups = {"self": selves, "others": others}
    return Agreement(
        users=len(users),
        pairs={name: sum(map(len, group.values())) for name, group in groups.items()},
        measures={name: _measures(group, len(users)) for name, group in groups.items()},
    )


def _numbered_users(demonstrations: Iterable[ReplayedDemonstration]) -> dict[str, int]:
    users: dict[str, int] = {}
    for demonstration in demonstrations:
        if demonstration.file.who is None:
            raise ValueError(
                "A demonstration names neither a user nor a participant; agreement is of users."
            )
        users.setdefault(demonstration.file.who, len(users))
    return users


def _check_days(demonstrations: Iterable[ReplayedDemonstration]) -> None:
    """Two of one day say nothing of how far a participant agrees with herself on another."""
    days = Counter((one.file.who, one.file.study.day) for one in demonstrations if one.file.study)
    for (who, day), count in days.items():
        if count > 1:
            raise ValueError(f"{who} has {count} demonstrations of day {day}; leave one of them.")


def _kitchen(demonstration: ReplayedDemonstration) -> tuple[str, int, int]:
    session = demonstration.session
    return session.split, session.index, session.salt


def _measures(compared: dict[tuple[int, int], list[Comparison]], users: int) -> dict[str, Interval]:
    found = {}
    for name in MEASURES:
        values = {
            pair: float(np.mean(known))
            for pair, comparisons in compared.items()
            if (known := [value for c in comparisons if (value := c[name]) is not None])
        }
        if values:
            found[name] = _over_users(values, users)
    return found


def _over_users(values: dict[tuple[int, int], float], users: int) -> Interval:
    """The mean over pairs of users, and its interval when users are drawn with replacement.

    A user who is drawn twice counts twice in each pair; a pair of two users counts as often as both
    are drawn together, and a user's own value as often as the user is.
    """
    pairs, numbers = np.array(list(values)), np.array(list(values.values()))  # (K, 2), (K,)
    generator = np.random.default_rng(0)
    times = generator.multinomial(users, [1 / users] * users, RESAMPLES)  # (R, U)
    itself = pairs[:, 0] == pairs[:, 1]
    weight = times[:, pairs[:, 0]] * np.where(itself, 1, times[:, pairs[:, 1]])  # (R, K)
    drawn = weight.sum(axis=1) > 0
    means = (weight @ numbers)[drawn] / weight.sum(axis=1)[drawn]
    low, high = np.quantile(means, (0.025, 0.975))
    return Interval(float(numbers.mean()), float(low), float(high))

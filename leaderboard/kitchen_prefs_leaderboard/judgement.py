"""Judges a submission by its policy's re-runs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from math import hypot, sqrt
from typing import Any

import numpy as np

from kitchen_prefs.evaluation.tiers import AnyEpisode, tier_of
from kitchen_prefs.metrics import Interval, mean_of_splits, score
from kitchen_prefs.splits import HELD_OUT_USERS
from kitchen_prefs_leaderboard.scoring import MEAN, Entry
from kitchen_prefs_leaderboard.submission_format import installed_packages
from kitchen_prefs_leaderboard.verification import PROCEDURE, ScoreInterval, Verification

ALIKE = 0.95  # of the episodes of a deterministic policy: other processors round otherwise
SIGNIFICANT = 1.96  # standard errors, for 95 %
# Standard errors by which the headline on fresh sessions, or alone, must differ to speak against a
# submission: with some comparisons for each of a board's rows, 1.96 would refuse one honest row in
# twenty.
SUSPICIOUS = 3.0
FIVE, TWO_HUNDRED = "unseen_preferences", "many_preferences"  # splits of so many other users

Episodes = Mapping[str, Sequence[Any]]  # of each test split of one tier
Headlines = Mapping[str, Sequence[float]]  # of each test split, what each session contributes


@dataclass(frozen=True)
class Reruns:
    """The episodes of a policy that was rolled out again, mixed into batches unless said otherwise.

    Attributes:
        published: On the published sessions.
        fresh: On fresh sessions.
        alone: On some of the fresh sessions, each in a batch of its own.
        again: On the published sessions once more; None if the first run repeats the submission.
        singly: On the published sessions, each in a batch of its own; None likewise.
    """

    published: Episodes
    fresh: Episodes
    alone: Episodes
    again: Episodes | None = None
    singly: Episodes | None = None

    @property
    def batched(self) -> list[Episodes]:
        """The runs on the published sessions that were mixed into batches."""
        return [self.published] + ([self.again] if self.again else [])

    @property
    def shown(self) -> Episodes:
        """The run whose headline is shown and ranked: the one that no batch can have helped."""
        return self.singly or self.published


def needs_more_runs(entry: Entry, first: Episodes) -> bool:
    """Whether a policy has to be rolled out again to be judged: it did not repeat its submission.

    A deterministic policy repeats itself; one that does not is rolled out twice more, once in other
    batches and once with each session in a batch of its own, so that its own spread is known.
    """
    return alike(entry.episodes, first) < ALIKE


def alike(episodes: Episodes, others: Episodes) -> float:
    """The share of the sessions of `others` in which both took the same decisions."""
    mine = {(e.split, e.session): e.decisions for of in episodes.values() for e in of}
    same = [mine[e.split, e.session] == e.decisions for of in others.values() for e in of]
    return sum(same) / len(same)


def compare(entry: Entry, reruns: Reruns, *, salt: int, by: str, sandbox: bool) -> Verification:
    """Judge a submission by its policy's re-runs.

    It repeats if at least 95 % of the episodes are alike. If they are not, but the policy repeats
    itself from run to run, the submission is another policy's. If it does not repeat itself either,
    the submission must lie within what the policy's own spread allows: the difference in the
    headline within 1.96 standard errors, which come from the runs and never from the submission.

    An episode is independent of others if, rolled out in a batch of its own, it goes as in a batch
    with others; of a policy that does not repeat itself, the headline with each session alone must
    lie within three such standard errors of the headline in batches.

    It generalises if on fresh sessions its headline is not lower than in the re-run by more than
    three standard errors: on the sessions of the training users, and on those of all others, whose
    fresh users are other users.

    Args:
        entry: The submission, replayed.
        reruns: The policy's episodes.
        salt: The session seed of the fresh sessions.
        by: Who re-runs.
        sandbox: Whether the policy's process was confined.
    """
    same = alike(entry.episodes, reruns.published)
    itself = alike(reruns.published, reruns.again) if reruns.again else None
    went_alone = alike(reruns.fresh, reruns.alone)
    if itself is None or itself >= ALIKE:
        repeats, independent = same >= ALIKE, went_alone >= ALIKE
    else:
        assert reruns.singly is not None
        runs = [*reruns.batched, reruns.singly]
        repeats = _likely(entry.episodes, runs, SIGNIFICANT)
        independent = _likely(reruns.singly, reruns.batched, SUSPICIOUS)
    scores = session_headlines([reruns.shown])
    return Verification(
        procedure=PROCEDURE,
        digest=entry.digest,
        by=by,
        sandbox=sandbox,
        packages=installed_packages(),
        salt=salt,
        runs=len(reruns.batched) + (reruns.singly is not None),
        same=same,
        itself=itself,
        alone=went_alone,
        replayed=_headline_of(entry.episodes),
        rerun=_headline_of(reruns.shown),
        fresh=_headline_of(reruns.fresh),
        scores={split: [round(value, 4) for value in scores[split]] for split in scores},
        repeats=repeats,
        independent=independent,
        generalises=_as_good_on_fresh(reruns, known=True)
        and _as_good_on_fresh(reruns, known=False),
    )


def rerun_headline(entry: Entry, verification: Verification, split: str) -> Interval:
    """The headline of the re-run on a split, or its mean over them: what is shown and ranked."""
    assert verification.scores is not None
    wanted = entry.tier.test_splits if split == MEAN else (split,)
    return _interval_of({name: entry.episodes[name] for name in wanted}, verification.scores)


def session_headlines(runs: Sequence[Episodes]) -> dict[str, list[float]]:
    """What each session of each split contributes to the headline, its mean over the runs."""
    return {
        split: np.mean([tier_of(split).session_headlines(run[split]) for run in runs], 0).tolist()
        for split in runs[0]
    }


def _headline_of(run: Episodes) -> ScoreInterval:
    return ScoreInterval(**asdict(_interval_of(run, session_headlines([run])).rounded()))


def _interval_of(episodes: Episodes, headlines: Headlines) -> Interval:
    """The mean of given headlines over the sessions of some episodes."""
    return mean_of_splits(list(episodes.values()), in_its_session(episodes, headlines))


def in_its_session(episodes: Episodes, headlines: Headlines) -> Callable[[AnyEpisode], float]:
    """Headlines in the sessions of some episodes, as a metric of any episode in these sessions."""
    of_session = {
        (e.split, e.session): value
        for split, of_split in episodes.items()
        for e, value in zip(of_split, headlines[split], strict=True)
    }
    return lambda e: of_session[e.split, e.session]


def _as_good_on_fresh(reruns: Reruns, *, known: bool) -> bool:
    """Whether the headline on fresh sessions is not significantly lower than on the published ones.

    Args:
        reruns: The policy's episodes, of which those that were mixed into batches are compared.
        known: Compare the sessions of the training users, else those of all others.
    """
    ours, theirs = _of_users(reruns.published, known), _of_users(reruns.fresh, known)
    if not ours:
        return True
    on_fresh, published = session_headlines([reruns.fresh]), session_headlines(reruns.batched)
    before = mean_of_splits(ours, in_its_session(reruns.published, published))
    after = mean_of_splits(theirs, in_its_session(reruns.fresh, on_fresh))
    sessions = hypot(before.mean - before.low, after.high - after.mean) / SIGNIFICANT
    users = 0.0 if known else _error_of_other_users(reruns.published, reruns.fresh)
    return before.mean - after.mean <= SUSPICIOUS * hypot(sessions, users)


def _error_of_other_users(published: Episodes, fresh: Episodes) -> float:
    """The standard error of the difference between five published and five fresh users.

    The bootstrap resamples the sessions of the five held-out users, who were the same, but fresh
    sessions are of five others. How much users differ is known from the two hundred others.
    The splits of the second tier have a user a session, whom the bootstrap resamples.
    """
    if FIVE not in published:
        return 0.0
    if {e.preference for e in fresh[FIVE]} == {e.preference for e in published[FIVE]}:
        return 0.0
    between = float(np.std([score(e) for e in fresh[TWO_HUNDRED]], ddof=1))
    splits = len(_of_users(fresh, known=False))
    share = (splits - 1) / splits  # of the splits with other users, one has two hundred
    return share * between * sqrt(2 / len(HELD_OUT_USERS))


def _of_users(episodes: Episodes, known: bool) -> list[list[Any]]:
    """Each split's episodes of the training users, or of all others, where there are some."""
    of_splits = [
        [e for e in of_split if (e.preference in tier_of(split).training_users) == known]
        for split, of_split in episodes.items()
    ]
    return [of_split for of_split in of_splits if of_split]


def _likely(run: Episodes, others: Sequence[Episodes], limit: float) -> bool:
    """Whether other runs make a run's headline likely, within `limit` standard errors."""
    difference, variance = 0.0, 0.0
    judged, known = session_headlines([run]), [session_headlines([other]) for other in others]
    for split in run:
        of_others = np.array([other[split] for other in known])  # (R, S)
        difference += (np.array(judged[split]) - of_others.mean(0)).mean() / len(run)
        # One run against the mean of R runs: each session adds its variance times 1 + 1/R.
        spread = of_others.var(0, ddof=1).sum() / of_others.shape[1] ** 2
        variance += (1 + 1 / len(others)) * spread / len(run) ** 2
    return bool(abs(difference) <= limit * sqrt(variance))

"""Judges a submission by its policy's re-runs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from math import hypot, sqrt

import numpy as np

from kitchen_prefs.metrics import Episode, Interval, mean_of_splits, score
from kitchen_prefs.splits import HELD_OUT_USERS, SEEN_USERS, TEST_SPLITS
from kitchen_prefs_leaderboard.scoring import MEAN, Entry
from kitchen_prefs_leaderboard.submission_format import installed_packages
from kitchen_prefs_leaderboard.verification import PROCEDURE, ScoreInterval, Verification

ALIKE = 0.95  # of the episodes of a deterministic policy: other processors round otherwise
STOCHASTIC_RUNS = 3
SIGNIFICANT = 1.96  # standard errors, for 95 %
# Standard errors by which Score on fresh sessions must be lower to speak against a submission: with
# two comparisons for each of a board's rows, 1.96 would refuse one honest row in twenty.
SUSPICIOUS = 3.0
FIVE, TWO_HUNDRED = "unseen_preferences", "many_preferences"  # splits of so many other users

Episodes = Mapping[str, Sequence[Episode]]  # of each test split


def needs_more_runs(entry: Entry, first: Episodes) -> bool:
    """Whether a policy has to be rolled out again to be judged: it did not repeat its submission.

    A deterministic policy repeats itself; one that does not is rolled out `STOCHASTIC_RUNS` times,
    so that its own spread is known, with each session in a batch of its own.
    """
    return alike(entry.episodes, first) < ALIKE


def alike(episodes: Episodes, others: Episodes) -> float:
    """The share of the sessions of `others` in which both took the same decisions."""
    mine = {(e.split, e.session): e.decisions for of in episodes.values() for e in of}
    same = [mine[e.split, e.session] == e.decisions for of in others.values() for e in of]
    return sum(same) / len(same)


def compare(
    entry: Entry,
    reruns: Sequence[Episodes],
    alone: Episodes,
    fresh: Episodes,
    *,
    salt: int,
    by: str,
    sandbox: bool,
) -> Verification:
    """Judge a submission by its policy's re-runs.

    It repeats if at least 95 % of the episodes are alike. If they are not, but the policy repeats
    itself from run to run, the submission is another policy's. If it does not repeat itself either,
    the submission must lie within what the policy's own spread allows: the difference in Score
    within 1.96 standard errors, which come from the runs and never from the submission.

    An episode is independent of others if, rolled out in a batch of its own, it goes as in a batch
    with others; of a policy that does not repeat itself this cannot be known, and its runs are of
    batches of one.

    It generalises if on fresh sessions its Score is not lower than in the re-run by more than three
    standard errors: on the sessions of the training users, and on those of all others, whose fresh
    users are other users.

    Args:
        entry: The submission, replayed.
        reruns: The policy's episodes on the published sessions, one or `STOCHASTIC_RUNS` times.
        alone: Its episodes on some fresh sessions, each in a batch of its own.
        fresh: Its episodes on fresh sessions.
        salt: The session seed of the fresh sessions.
        by: Who re-runs.
        sandbox: Whether the policy's process was confined.
    """
    same = alike(entry.episodes, reruns[0])
    itself = alike(reruns[0], reruns[1]) if len(reruns) > 1 else None
    deterministic = itself is None or itself >= ALIKE
    scores = _mean_scores(reruns)
    rerun = _interval_of(reruns[0], scores)
    on_fresh = mean_of_splits(list(fresh.values()), score)
    went_alone = alike(fresh, alone)
    return Verification(
        procedure=PROCEDURE,
        digest=entry.digest,
        by=by,
        sandbox=sandbox,
        packages=installed_packages(),
        salt=salt,
        runs=len(reruns),
        same=same,
        itself=itself,
        alone=went_alone,
        replayed=_score_interval(entry.metrics[MEAN]["Score"]),
        rerun=_score_interval(rerun),
        fresh=_score_interval(on_fresh),
        scores={split: [round(value, 4) for value in scores[split]] for split in scores},
        repeats=same >= ALIKE if deterministic else _within_spread(entry, reruns),
        independent=went_alone >= ALIKE or not deterministic,
        generalises=all(
            _as_good_on_fresh(reruns[0], scores, fresh, known=known) for known in (True, False)
        ),
    )


def rerun_score(entry: Entry, verification: Verification, split: str) -> Interval:
    """Score of the re-run on a split, or its mean over them: what is shown and ranked."""
    assert verification.scores is not None
    wanted = TEST_SPLITS if split == MEAN else (split,)
    return _interval_of({name: entry.episodes[name] for name in wanted}, verification.scores)


def _mean_scores(reruns: Sequence[Episodes]) -> dict[str, list[float]]:
    """Score in each session, its mean over the runs."""
    return {
        split: np.mean([[score(e) for e in run[split]] for run in reruns], axis=0).tolist()
        for split in reruns[0]
    }


def _interval_of(episodes: Episodes, scores: Mapping[str, Sequence[float]]) -> Interval:
    """The mean of given scores over the sessions of some episodes."""
    return mean_of_splits(list(episodes.values()), in_its_session(episodes, scores))


def in_its_session(
    episodes: Episodes, scores: Mapping[str, Sequence[float]]
) -> Callable[[Episode], float]:
    """Scores of the sessions of some episodes, as a metric of any episode in these sessions."""
    of_session = {
        (e.split, e.session): value
        for split, of_split in episodes.items()
        for e, value in zip(of_split, scores[split], strict=True)
    }
    return lambda e: of_session[e.split, e.session]


def _as_good_on_fresh(
    published: Episodes, scores: Mapping[str, Sequence[float]], fresh: Episodes, *, known: bool
) -> bool:
    """Whether Score on fresh sessions is not significantly lower than on the published ones.

    Args:
        published: The episodes of the published sessions.
        scores: Score in each of them.
        fresh: The episodes of the fresh sessions.
        known: Compare the sessions of the training users, else those of all others.
    """
    ours, theirs = _of_users(published, known), _of_users(fresh, known)
    before = mean_of_splits(ours, in_its_session(published, scores))
    after = mean_of_splits(theirs, score)
    sessions = hypot(before.mean - before.low, after.high - after.mean) / SIGNIFICANT
    users = 0.0 if known else _error_of_other_users(published, fresh)
    return before.mean - after.mean <= SUSPICIOUS * hypot(sessions, users)


def _error_of_other_users(published: Episodes, fresh: Episodes) -> float:
    """The standard error of the difference between five published and five fresh users.

    The bootstrap resamples the sessions of the five held-out users, who were the same, but fresh
    sessions are of five others. How much users differ is known from the two hundred others.
    """
    if {e.preference for e in fresh[FIVE]} == {e.preference for e in published[FIVE]}:
        return 0.0
    between = float(np.std([score(e) for e in fresh[TWO_HUNDRED]], ddof=1))
    splits = len(_of_users(fresh, known=False))
    share = (splits - 1) / splits  # of the splits with other users, one has two hundred
    return share * between * sqrt(2 / len(HELD_OUT_USERS))


def _of_users(episodes: Episodes, known: bool) -> list[list[Episode]]:
    """Each split's episodes of the training users, or of all others, where there are some."""
    of_splits = [
        [e for e in of_split if (e.preference in SEEN_USERS) == known]
        for of_split in episodes.values()
    ]
    return [of_split for of_split in of_splits if of_split]


def _within_spread(entry: Entry, reruns: Sequence[Episodes]) -> bool:
    """Whether the submission's Score is one that the policy's own runs make likely."""
    difference, variance = 0.0, 0.0
    for split in TEST_SPLITS:
        runs = np.array([[score(e) for e in run[split]] for run in reruns])  # (R, S)
        submitted = np.array([score(e) for e in entry.episodes[split]])  # (S,)
        difference += (submitted - runs.mean(0)).mean() / len(TEST_SPLITS)
        # One run against the mean of R runs: each session adds its variance times 1 + 1/R.
        spread = runs.var(0, ddof=1).sum() / runs.shape[1] ** 2
        variance += (1 + 1 / len(runs)) * spread / len(TEST_SPLITS) ** 2
    return bool(abs(difference) <= SIGNIFICANT * sqrt(variance))


def _score_interval(interval: Interval) -> ScoreInterval:
    return ScoreInterval(**asdict(interval.rounded()))

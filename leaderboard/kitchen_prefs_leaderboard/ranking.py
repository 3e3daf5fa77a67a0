"""The order of the entries: by the headline, with ties where they do not differ significantly."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from kitchen_prefs.evaluation.tiers import TIERS, AnyEpisode
from kitchen_prefs.metrics import Interval, mean_of_splits
from kitchen_prefs_leaderboard.judgement import in_its_session, session_headlines
from kitchen_prefs_leaderboard.scoring import MEAN, Entry
from kitchen_prefs_leaderboard.submission_format import TRACKS
from kitchen_prefs_leaderboard.verification import Verification


@dataclass(frozen=True)
class Row:
    """An entry and its rank.

    Attributes:
        entry: The entry.
        verification: The re-run that confirms it; None where it was only replayed.
        rank: 1 for the best and all that tie with it; None where it was only replayed.
        tied: Whether others share the rank.
    """

    entry: Entry
    verification: Verification | None = None
    rank: int | None = None
    tied: bool = False


def rank_tiers(
    entries: Sequence[Entry], verified: dict[str, Verification]
) -> dict[str, dict[str, list[Row]]]:
    """The rows of each track of each tier that has entries, see `rank`."""
    of_tiers = {name: [e for e in entries if e.tier is tier] for name, tier in TIERS.items()}
    return {name: rank(of_tier, verified) for name, of_tier in of_tiers.items() if of_tier}


def rank(entries: Sequence[Entry], verified: dict[str, Verification]) -> dict[str, list[Row]]:
    """The rows of each track, the ranked ones first.

    Args:
        entries: Entries of one tier.
        verified: Re-runs that confirm an entry, by its digest.
    """
    tables = {}
    for track in TRACKS:
        rows = [Row(e, verified.get(e.digest)) for e in entries if e.submission.track == track]
        rows.sort(key=lambda row: (-_ranking_headline(row), row.entry.submission.name))
        if rows:
            tables[track] = [
                *_ranked([row for row in rows if row.verification]),
                *(row for row in rows if not row.verification),
            ]
    return tables


def _ranking_headline(row: Row) -> float:
    """The one that counts: the re-run's, and for a record of an earlier procedure the lower."""
    replayed = row.entry.metrics[MEAN][row.entry.tier.ranking].mean
    if row.verification is None:
        return replayed
    if row.verification.scores is None:
        return min(replayed, row.verification.rerun.mean)
    return row.verification.rerun.mean


def _ranked(rows: Sequence[Row]) -> list[Row]:
    """Give ranks to rows that are sorted.

    A row ties with the first of a rank as long as the paired interval of their difference holds
    zero.
    """
    groups: list[list[Row]] = []
    for row in rows:
        if groups and lead(groups[-1][0], row).low <= 0:
            groups[-1].append(row)
        else:
            groups.append([row])
    ranked: list[Row] = []
    for group in groups:
        rank, tied = len(ranked) + 1, len(group) > 1
        ranked += [replace(row, rank=rank, tied=tied) for row in group]
    return ranked


def lead(first: Row, second: Row) -> Interval:
    """The difference in the headline between two rows, of the re-runs if recorded.

    The paired bootstrap: the sessions' differences are resampled.
    """
    ours, theirs = _headline_that_counts(first), _headline_that_counts(second)
    return mean_of_splits(list(first.entry.episodes.values()), lambda e: ours(e) - theirs(e))


def _headline_that_counts(row: Row) -> Callable[[AnyEpisode], float]:
    """What a session contributes to a row's headline, of an episode in it of any row's."""
    episodes = row.entry.episodes
    recorded = row.verification.scores if row.verification else None
    return in_its_session(episodes, recorded or session_headlines([episodes]))

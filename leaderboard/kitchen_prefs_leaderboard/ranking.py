"""The order of the entries: by Score, with ties where the difference is not significant."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from kitchen_prefs_leaderboard.scoring import MEAN, Entry, difference
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


def rank(entries: Sequence[Entry], verified: dict[str, Verification]) -> dict[str, list[Row]]:
    """The rows of each track, the ranked ones first.

    Args:
        entries: Entries of one data version.
        verified: Re-runs that confirm an entry, by its digest.
    """
    tables = {}
    for track in TRACKS:
        rows = [Row(e, verified.get(e.digest)) for e in entries if e.submission.track == track]
        rows.sort(key=lambda row: (-_ranking_score(row), row.entry.submission.name))
        if rows:
            tables[track] = [
                *_ranked([row for row in rows if row.verification]),
                *(row for row in rows if not row.verification),
            ]
    return tables


def _ranking_score(row: Row) -> float:
    """The Score that counts: the lower one of the submission and its re-run."""
    replayed = row.entry.metrics[MEAN]["Score"].mean
    return min(replayed, row.verification.rerun.mean) if row.verification else replayed


def _ranked(rows: Sequence[Row]) -> list[Row]:
    """Give ranks to rows that are sorted.

    A row ties with the first of a rank as long as the paired interval of their difference holds
    zero.
    """
    groups: list[list[Row]] = []
    for row in rows:
        if groups and difference(groups[-1][0].entry.episodes, row.entry.episodes).low <= 0:
            groups[-1].append(row)
        else:
            groups.append([row])
    ranked: list[Row] = []
    for group in groups:
        rank, tied = len(ranked) + 1, len(group) > 1
        ranked += [replace(row, rank=rank, tied=tied) for row in group]
    return ranked

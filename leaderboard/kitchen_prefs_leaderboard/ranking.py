"""The order of the entries: by Score, with ties where the sessions cannot tell two apart."""

from collections.abc import Sequence
from dataclasses import dataclass

from kitchen_prefs_leaderboard.scoring import MEAN, Entry, difference
from kitchen_prefs_leaderboard.submission import TRACKS
from kitchen_prefs_leaderboard.verification import Verification


@dataclass(frozen=True)
class Row:
    """An entry's place.

    Attributes:
        entry: The entry.
        rank: 1 for the best and all that tie with it; None where it was only replayed.
        tied: Whether others share the rank.
    """

    entry: Entry
    rank: int | None
    tied: bool = False


def rank(entries: Sequence[Entry], verified: dict[str, Verification]) -> dict[str, list[Row]]:
    """The rows of each track, the ranked ones first.

    Args:
        entries: Entries of one data version.
        verified: Re-runs that confirm an entry, by its digest.
    """
    tables = {}
    for track in TRACKS:
        mine = sorted(
            (entry for entry in entries if entry.submission.track == track),
            key=lambda entry: -entry.metrics[MEAN]["Score"].mean,
        )
        again = [entry for entry in mine if entry.digest in verified]
        rest = [Row(entry, None) for entry in mine if entry.digest not in verified]
        if mine:
            tables[track] = _ranked(again) + rest
    return tables


def _ranked(entries: Sequence[Entry]) -> list[Row]:
    """Ranks of entries that are sorted by Score.

    An entry ties with the first of a rank as long as the paired interval of their difference holds
    zero.
    """
    groups: list[list[Entry]] = []
    for entry in entries:
        if groups and difference(groups[-1][0].episodes, entry.episodes).low <= 0:
            groups[-1].append(entry)
        else:
            groups.append([entry])
    rows, place = [], 1
    for group in groups:
        rows += [Row(entry, place, tied=len(group) > 1) for entry in group]
        place += len(group)
    return rows

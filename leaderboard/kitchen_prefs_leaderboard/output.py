"""Scores as a table in the terminal, as JSON and as CSV."""

import csv
import io
import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict

from rich.table import Table

from kitchen_prefs.metrics import METRICS, Interval
from kitchen_prefs_leaderboard.scoring import Entry
from kitchen_prefs_leaderboard.verification import Verification

DIGITS = 4  # the bootstrap tells no more than three; a fourth keeps rounding out of them


def to_tables(entry: Entry, by: str | None) -> Iterator[Table]:
    """An entry's metrics for the terminal."""
    metrics = Table("Split", *METRICS, title=entry.submission.name)
    for split, of_split in entry.metrics.items():
        metrics.add_row(split, *(_lines(of_split[name]) for name in METRICS))
    yield metrics
    if by:
        groups = Table(
            "Split", by.capitalize(), *METRICS, title=f"{entry.submission.name}, by {by}"
        )
        for split, of_groups in entry.grouped(by).items():
            for group, of_group in of_groups.items():
                groups.add_row(split, group, *(_lines(of_group[name]) for name in METRICS))
        yield groups
    reasons = Table("Episodes that fell short by", *entry.episodes)
    for reason in next(iter(entry.shortcomings.values())):
        reasons.add_row(reason, *(str(of[reason]) for of in entry.shortcomings.values()))
    yield reasons


def to_comparison(found: Verification) -> Table:
    """A re-run beside the replay, for the terminal."""
    verdict = "confirmed" if found.confirmed else "NOT confirmed"
    title = f"{verdict}; {found.same:.0%} of the episodes were decided alike"
    table = Table("Score", "Mean", "95 % interval", title=title)
    rows = {"replayed": found.replayed, "run again": found.rerun, "fresh sessions": found.fresh}
    for name, means in rows.items():
        table.add_row(name, f"{means.mean:.3f}", f"{means.low:.3f} to {means.high:.3f}")
    return table


def to_json(entries: Sequence[Entry], by: str | None) -> str:
    """All metrics of entries."""
    content = [
        {
            "name": entry.submission.name,
            "track": entry.submission.track,
            "data_version": entry.submission.data_version,
            "digest": entry.digest,
            "splits": _rounded(entry.metrics),
            "shortcomings": entry.shortcomings,
            **({by: _rounded(entry.grouped(by))} if by else {}),
        }
        for entry in entries
    ]
    return json.dumps(content, indent=2) + "\n"


def to_csv(entries: Sequence[Entry], by: str | None) -> str:
    """All metrics of entries, one a line."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["name", "track", "split", by or "group", "metric", "mean", "low", "high"])
    for entry in entries:
        who = [entry.submission.name, entry.submission.track]
        for split, of_split in entry.metrics.items():
            for name, interval in of_split.items():
                writer.writerow([*who, split, "all", name, *_numbers(interval).values()])
        for split, of_groups in (entry.grouped(by) if by else {}).items():
            for group, of_group in of_groups.items():
                for name, interval in of_group.items():
                    writer.writerow([*who, split, group, name, *_numbers(interval).values()])
    return file.getvalue()


def _lines(interval: Interval) -> str:
    return f"{interval.mean:.3f}\n{interval.low:.3f}..{interval.high:.3f}"


def _numbers(interval: Interval) -> dict[str, float]:
    return {name: round(value, DIGITS) for name, value in asdict(interval).items()}


def _rounded(tree: dict) -> dict:
    return {
        key: _numbers(value) if isinstance(value, Interval) else _rounded(value)
        for key, value in tree.items()
    }

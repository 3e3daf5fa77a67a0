"""Scores as a table in the terminal, as JSON and as CSV."""

import csv
import io
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, astuple

from rich.table import Table
from rich.text import Text

from kitchen_prefs.evaluation.tiers import Tier
from kitchen_prefs.metrics import Interval
from kitchen_prefs_leaderboard.scoring import Entry
from kitchen_prefs_leaderboard.verification import Verification


def to_tables(entry: Entry, by: str | None) -> Iterator[Table]:
    """An entry's metrics for the terminal."""
    grouped = entry.grouped(by) if by else {}
    # Two tables, because all metrics side by side are wider than a terminal.
    for names, which in zip(entry.tier.tables, ("means", "further means"), strict=True):
        title = f"{entry.submission.name}: {which} with 95 % intervals"
        metrics = _table(title, "Split", *names)
        for split, of_split in entry.metrics.items():
            metrics.add_row(split, *_cells(of_split, names))
        yield metrics
        if by:
            groups = _table(f"{title}, by {by}", "Split", *names)
            for split, of_groups in grouped.items():
                for group, of_group in of_groups.items():
                    groups.add_row(f"{split}\n{by} {group}", *_cells(of_group, names))
            yield groups
    modes = _table(
        "Episodes with failure modes", "Split", *next(iter(entry.failure_modes.values()))
    )
    for split, counts in entry.failure_modes.items():
        modes.add_row(split, *map(str, counts.values()))
    yield modes
    yield _references(entry.tier)


def _references(tier: Tier) -> Table:
    """The headlines of floor and ceiling on the test splits of a tier."""
    table = _table(f"{tier.headline} of floor and ceiling", "Split", tier.floor, tier.ceiling)
    for split in tier.test_splits:
        table.add_row(split, *(f"{value:.3f}" for value in tier.references()[split].values()))
    return table


def to_comparison(found: Verification, tier: Tier) -> Table:
    """A re-run beside the replay, for the terminal."""
    table = _table(f"{tier.title}, all test splits", tier.ranking, "Mean", "95 % interval")
    rows = {"replayed": found.replayed, "run again": found.rerun, "fresh sessions": found.fresh}
    for name, means in rows.items():
        table.add_row(name, f"{means.mean:.3f}", f"{means.low:.3f} to {means.high:.3f}")
    return table


def to_verdict(found: Verification) -> str:
    """Whether a re-run confirms a submission, in a sentence."""
    same = f"{found.same:.0%} of the episodes have the same decisions"
    if found.confirmed:
        return f"The re-run confirms the submission; {same}."
    if not found.repeats:
        why = "the policy does something else"
    elif not found.independent:
        why = f"its episodes depend on each other ({found.alone:.0%} went alike alone)"
    else:
        why = "its headline on fresh sessions is lower"
    return f"The re-run does NOT confirm the submission: {why}; {same}."


def to_json(entries: Sequence[Entry], by: str | None) -> str:
    """All metrics of entries."""
    content = [
        {
            "name": entry.submission.name,
            "track": entry.submission.track,
            "data_version": entry.tier.data_version,
            "digest": entry.digest,
            "splits": _tree(entry.metrics),
            "shortcomings": entry.failure_modes,
            **({by: _tree(entry.grouped(by))} if by else {}),
        }
        for entry in entries
    ]
    return json.dumps(content, indent=2) + "\n"


def to_csv(entries: Sequence[Entry], by: str | None) -> str:
    """All metrics of entries, one per line."""
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(["name", "track", "split", by or "group", "metric", "mean", "low", "high"])
    for entry in entries:
        who = [entry.submission.name, entry.submission.track]
        for split, of_split in entry.metrics.items():
            for name, interval in of_split.items():
                writer.writerow([*who, split, "all", name, *astuple(interval.rounded())])
        for split, of_groups in (entry.grouped(by) if by else {}).items():
            for group, of_group in of_groups.items():
                for name, interval in of_group.items():
                    writer.writerow([*who, split, group, name, *astuple(interval.rounded())])
    return file.getvalue()


def _table(title: str, *heads: str) -> Table:
    """A table that fits into 80 columns; its title is untrusted and not read as markup."""
    table = Table(title=Text(title), box=None, padding=(0, 1, 0, 0))
    first, *rest = heads
    table.add_column(first, no_wrap=True)
    for head in rest:
        table.add_column(head, justify="right", min_width=9)  # fits "forbidden"
    return table


def _cells(metrics: Mapping[str, Interval], names: Iterable[str]) -> list[str]:
    return [_cell(metrics[name]) if name in metrics else "-" for name in names]


def _cell(of: Interval) -> str:
    return f"{of.mean:.3f}\n{_short(of.low)} {_short(of.high)}"


def _short(value: float) -> str:
    """Two decimals, and no zero alone before the point."""
    text = f"{value:.2f}"
    return text.replace("0.", ".", 1) if abs(value) < 1 else text


def _tree(tree: dict) -> dict:
    return {
        key: asdict(value.rounded()) if isinstance(value, Interval) else _tree(value)
        for key, value in tree.items()
    }

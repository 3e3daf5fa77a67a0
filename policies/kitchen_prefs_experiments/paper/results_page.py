"""RESULTS.md: every table that has been run, our figures beside the paper's.

Prose stands in results/introduction.md and, under each table, results/TABLE.md.
"""

from collections.abc import Iterator
from pathlib import Path

from kitchen_prefs.metrics import Interval
from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.result_files import (
    CurveResults,
    CurveRow,
    PolicyResults,
    PolicyRow,
    read_results,
)
from kitchen_prefs_experiments.paper.table_types import Curves, Table

YARDSTICK = "symbolic"  # the row whose means the shares are of
HOW_TO_READ = (
    "Cells are means over episodes with 95 % bootstrap intervals; behind a name stands the number "
    "of its episodes. Each policy was trained once, so the intervals say nothing of other seeds. A "
    "percentage is the share of what the symbolic rule reaches, which reads the preference out of "
    "the prompt by a written rule. The README says what metrics, splits and rules are."
)


def report(folder: Path) -> str:
    """RESULTS.md, written from the files of a folder alone.

    Args:
        folder: Holds TABLE.json, TABLE.png and the prose.

    Returns:
        The report as Markdown.

    Raises:
        ValueError: If a file is damaged.
    """
    found = read_results(folder)
    parts = ["# Results", *_prose(folder / "introduction.md"), HOW_TO_READ]
    for name, facts in found.items():
        parts += _section(name, TABLES[name], facts, folder)
    if missing := [f"`{name}`" for name in TABLES if name not in found]:
        parts += [
            "## Not there yet",
            f"{', '.join(missing)}: `kitchen-prefs reproduce TABLE` runs a table, and "
            "`kitchen-prefs results` writes this page anew.",
        ]
    return "\n\n".join(parts) + "\n"


def _section(
    name: str, table: Table | Curves, facts: PolicyResults | CurveResults, folder: Path
) -> Iterator[str]:
    yield f"## {table.title}"
    yield f"In the paper: {table.paper}"
    if table.note:
        yield f"Here: {table.note}"
    yield f"![{table.title}]({folder.name}/{name}.png)"
    yield from _figures(table, facts.rows)
    yield _how_made(name, facts)
    yield from _prose(folder / f"{name}.md")


def _figures(table: Table | Curves, rows: dict) -> Iterator[str]:
    if isinstance(table, Curves):
        yield _by_recipe(table, rows)
    elif len(table.groups) > 1:
        for metric in table.metrics:
            yield f"**{metric}**"
            yield _by_group(table, rows, metric)
    else:
        yield _by_metric(table, rows)


def _prose(file: Path) -> list[str]:
    return [file.read_text().strip()] if file.exists() else []


def _by_group(table: Table, rows: dict[str, PolicyRow], metric: str) -> str:
    """One metric: a row for each policy, a column for each group that has it."""
    yardstick = rows[YARDSTICK].groups
    groups = [group for group in table.groups if metric in yardstick[group].metrics]
    lines = [["", *(f"{group} ({yardstick[group].episodes})" for group in groups)]]
    for row, facts in rows.items():
        means = [facts.groups[group].metrics[metric] for group in groups]
        whole = [yardstick[group].metrics[metric].mean for group in groups]
        cells = [f"{_cell(m)}, {_share(m, of)}" for m, of in zip(means, whole, strict=True)]
        lines.append([row, *cells])
    if metric == table.metrics[0]:
        for row, values in table.paper_values.items():
            lines.append([row, *(_number(values.get(group)) for group in groups)])
    return _markdown(lines)


def _by_metric(table: Table, rows: dict[str, PolicyRow]) -> str:
    """One group: a row for each policy, a column for each metric and each of the paper's."""
    (group,) = table.groups
    episodes = next(iter(rows.values())).groups[group].episodes
    metrics = [f"{metric} on {group} ({episodes})" for metric in table.metrics]
    papers = [f"{table.metrics[0]}, {name}" for name in table.paper_values]
    lines = [[table.axis, *metrics, *papers]]
    for row, facts in rows.items():
        means = facts.groups[group].metrics
        cells = [_cell(means[metric]) for metric in table.metrics]
        values = [_number(of.get(row)) for of in table.paper_values.values()]
        lines.append([row, *cells, *values])
    return _markdown(lines)


def _by_recipe(curves: Curves, rows: dict[str, CurveRow]) -> str:
    """A row for each recipe: how long it was trained, and what its best checkpoint is worth."""
    metrics = [f"{metric} at the best step" for metric in curves.drawn]
    lines = [["recipe", "steps", "minutes", "best step", *metrics]]
    for recipe, facts in rows.items():
        (best,) = [point for point in facts.points if point.step == facts.best]
        cells = [_cell(best.metrics[metric]) for metric in curves.drawn]
        minutes = f"{facts.seconds / 60:.0f}"
        lines.append([f"`{recipe}`", f"{facts.steps:,}", minutes, f"{best.step:,}", *cells])
    return _markdown(lines)


def _how_made(name: str, facts: PolicyResults | CurveResults) -> str:
    """The command that made the facts, and under which conditions."""
    versions = f"data version {facts.data_version}, package {facts.package_version}"
    if facts.budget is None:
        return f"Made by `kitchen-prefs reproduce {name}`; {versions}."
    seconds = list(_seconds(facts.rows))
    recipes = " and ".join(f"`{recipe}`" for recipe in facts.recipes or [])
    return (
        f"Made by `kitchen-prefs reproduce {name} --budget={facts.budget}`; {versions}. Each "
        f"training from nothing saw {facts.budget:,} decisions with the recipe {recipes}; the "
        f"trainings took {min(seconds):,} to {max(seconds):,} s each."
    )


def _seconds(rows: dict) -> Iterator[int]:
    """How long each training took; a row may stand for several."""
    for row in rows.values():
        yield from (of.seconds for of in row.policies or [row] if of.seconds is not None)


def _markdown(lines: list[list[str]]) -> str:
    header, *rows = lines
    return "\n".join(f"| {' | '.join(line)} |" for line in (header, ["---"] * len(header), *rows))


def _cell(interval: Interval) -> str:
    return f"{interval.mean:.2f} [{interval.low:.2f}, {interval.high:.2f}]"


def _share(interval: Interval, whole: float) -> str:
    return f"{interval.mean / whole:.0%}" if whole > 0 and interval.mean >= 0 else "-"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"

"""The pages of results: an overview, and a page for each table that has been run.

Everything comes from the folder of results: numbers from TABLE.json, prose from prose/TABLE.md and,
for the overview, prose/index.md. A row that an earlier page shows is linked, and rows in which all
numbers are equal become one sentence.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from statistics import stdev

from kitchen_prefs.splits import TEST_SPLITS
from kitchen_prefs_experiments.markdown import interval_cell, markdown_table
from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.result_files import (
    CurveResults,
    CurveRow,
    PolicyResults,
    PolicyRow,
    read_results,
)
from kitchen_prefs_experiments.paper.table_types import Curves, Table

OVERVIEW = "index"
HOW_TO_READ = (
    "Cells are means over episodes with 95 % bootstrap intervals; behind the name of a split "
    "stands its number of episodes. Each row is a single training, so the intervals say nothing "
    "about other seeds. [Metrics and protocol](../metrics_and_protocol.md) defines metrics, splits "
    "and rules."
)


def pages(folder: Path) -> dict[str, str]:
    """All pages, written from the files of a folder alone.

    Args:
        folder: Holds TABLE.json and prose/.

    Returns:
        For each page its name, without `.md`, and its Markdown.

    Raises:
        ValueError: If a file is damaged.
    """
    found = read_results(folder)
    overview = {OVERVIEW: _overview(found, folder)}
    return overview | {name: _page(name, found, folder) for name in found}


def _overview(found: Mapping[str, PolicyResults | CurveResults], folder: Path) -> str:
    lines = [["table", "rows", "evaluated on"]]
    for name in found:
        title, rows = TABLES[name].title, " · ".join(TABLES[name].rows)
        lines.append([f"[{title}]({name}.md)", rows, _evaluated_on(name)])
    parts = [
        "# Results",
        *_prose(folder, OVERVIEW),
        "## The tables",
        markdown_table(lines[0], lines[1:]),
        HOW_TO_READ,
    ]
    if missing := [f"`{name}`" for name in TABLES if name not in found]:
        parts.append(
            f"Not run yet: {', '.join(missing)}. `kitchen-prefs reproduce TABLE` runs a table, and "
            "`kitchen-prefs results` writes these pages."
        )
    return _joined(parts)


def _evaluated_on(name: str) -> str:
    table = TABLES[name]
    splits = ("val",) if isinstance(table, Curves) else table.splits
    return "the test splits" if splits == TEST_SPLITS else ", ".join(f"`{s}`" for s in splits)


def _page(name: str, found: Mapping[str, PolicyResults | CurveResults], folder: Path) -> str:
    table, results = TABLES[name], found[name]
    parts = [f"# {table.title}", f"**In the paper.** {table.paper}"]
    if table.note:
        parts.append(f"**Here.** {table.note}")
    parts.append(f"![{table.title}]({name}.png)")
    parts += [*_prose(folder, name), "## Figures"]
    if isinstance(table, Curves):
        assert isinstance(results, CurveResults)
        parts.append(_by_recipe(table, results.rows))
    else:
        assert isinstance(results, PolicyResults)
        if len(table.groups) == 1:
            parts.append(_by_metric(table, results.rows))
        else:
            parts += _by_group(table, results.rows, _shown_before(name, found))
    parts += ["## Reproduce", _how_made(name, results)]
    return _joined(parts)


def _shown_before(name: str, found: Mapping[str, PolicyResults | CurveResults]) -> dict[str, str]:
    """The rows of a table that an earlier page shows, label -> the name of that page."""
    shown: dict[str, str] = {}
    for earlier in found:
        if earlier == name:
            break
        if _groups(earlier) == _groups(name):
            mine, theirs = found[name].rows, found[earlier].rows
            for label in mine.keys() & theirs.keys() - shown.keys():
                shown[label] = earlier
    return shown


def _groups(name: str) -> tuple[str, ...]:
    table = TABLES[name]
    return () if isinstance(table, Curves) else table.groups


def _by_group(table: Table, rows: dict[str, PolicyRow], shown: Mapping[str, str]) -> Iterator[str]:
    """A table for each metric: a row for each policy, a column for each group that has it."""
    if links := [f"[{row}]({shown[row]}.md)" for row in rows if row in shown]:
        yield f"To compare with, on other pages: {', '.join(links)}."
    own = {label: row for label, row in rows.items() if label not in shown}
    for metric in table.metrics:
        yield f"### {metric}"
        yield from _of_metric(table, own, metric)


def _of_metric(table: Table, rows: dict[str, PolicyRow], metric: str) -> Iterator[str]:
    groups_of = {label: row.groups for label, row in rows.items()}
    any_row = next(iter(groups_of.values()))
    groups = [group for group in table.groups if metric in any_row[group].metrics]
    lines = {
        row: [interval_cell(of[group].metrics[metric]) for group in groups]
        for row, of in groups_of.items()
    }
    constant = {row: cells[0] for row, cells in lines.items() if len({*cells}) == 1 < len(cells)}
    body = [[row, *cells] for row, cells in lines.items() if row not in constant]
    if table.spread:
        means = [[of[group].metrics[metric].mean for of in groups_of.values()] for group in groups]
        body.append(["SD of the seeds", *(f"{stdev(of_group):.3f}" for of_group in means)])
    if metric == table.metrics[0]:
        for label, values in table.paper_values.items():
            body.append([label, *(_number(values.get(group)) for group in groups)])
    if body:
        head = ["", *(f"{group} ({any_row[group].episodes})" for group in groups)]
        yield markdown_table(head, body)
    if constant:
        cells = "; ".join(f"{row} {cell}" for row, cell in constant.items())
        yield f"The same in every column: {cells}."


def _by_metric(table: Table, rows: dict[str, PolicyRow]) -> str:
    """One group: a row for each policy, a column for each metric and each of the paper's."""
    (group,) = table.groups
    episodes = next(iter(rows.values())).groups[group].episodes
    metrics = [f"{metric} on {group} ({episodes})" for metric in table.metrics]
    papers = [f"{table.metrics[0]}, {name}" for name in table.paper_values]
    lines = [[table.axis, *metrics, *papers]]
    for label, row in rows.items():
        means = row.groups[group].metrics
        cells = [interval_cell(means[metric]) for metric in table.metrics]
        values = [_number(of.get(label)) for of in table.paper_values.values()]
        lines.append([label, *cells, *values])
    return markdown_table(lines[0], lines[1:])


def _by_recipe(curves: Curves, rows: dict[str, CurveRow]) -> str:
    """A row for each recipe: how long it was trained, and the metrics of its best checkpoint."""
    metrics = [f"{metric} at the best step" for metric in curves.drawn]
    lines = [["recipe", "steps", "minutes", "best step", *metrics]]
    for recipe, row in rows.items():
        (best,) = [point for point in row.points if point.step == row.best]
        cells = [interval_cell(best.metrics[metric]) for metric in curves.drawn]
        minutes = f"{row.seconds / 60:.0f}"
        lines.append([f"`{recipe}`", f"{row.steps:,}", minutes, f"{best.step:,}", *cells])
    return markdown_table(lines[0], lines[1:])


def _how_made(name: str, results: PolicyResults | CurveResults) -> str:
    """The command that made the results, and its conditions."""
    versions = f"data version {results.data_version}, package {results.package_version}"
    if not isinstance(results, PolicyResults) or results.budget is None:
        return f"`kitchen-prefs reproduce {name}` made the figures; {versions}."
    seconds = list(_seconds(results.rows))
    recipes = " and ".join(f"`{recipe}`" for recipe in results.recipes or ())
    return (
        f"`kitchen-prefs reproduce {name} --budget={results.budget}` made the figures; "
        f"{versions}. Each training from scratch saw {results.budget:,} decisions with the recipe "
        f"{recipes}; the trainings took {min(seconds):,} to {max(seconds):,} s each."
    )


def _seconds(rows: dict[str, PolicyRow]) -> Iterator[int]:
    """The duration of each training; a row may have several."""
    for row in rows.values():
        yield from (of.seconds for of in row.policies or [row] if of.seconds is not None)


def _prose(folder: Path, name: str) -> list[str]:
    file = folder / "prose" / f"{name}.md"
    return [file.read_text().strip()] if file.exists() else []


def _joined(parts: list[str]) -> str:
    return "\n\n".join(parts) + "\n"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.3g}"

"""The figures of the tables: our means with their intervals, and the paper's values beside them."""

from collections.abc import Iterator
from pathlib import Path

import altair as alt

from kitchen_prefs.utils.files import atomic_file
from kitchen_prefs_experiments.paper.result_files import CurveResults, PolicyResults
from kitchen_prefs_experiments.paper.table_types import Curves, Table

PACKING_EFFICIENCY = "packing efficiency PE (share of the expert's)"
AXES = {
    "Score": "Score (mean of PE and ED_c)",
    "PE": PACKING_EFFICIENCY,
    "PE, other prompt": PACKING_EFFICIENCY,
    "ED_c": "edit similarity to the expert's decisions ED_c",
    "Category accuracy": "category accuracy (share of decisions)",
    "Pick accuracy": "category accuracy (share of pick decisions)",
}
# Okabe and Ito's colours, safe for colour-blind readers; the paper's are black and grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#56B4E9", "#CC79A7", "#8A7A2E", "#882255")
PAPER_COLOURS = ("#000000", "#888888")
STEP = 14  # pixels between marks side by side
MIN_WIDTH = 560  # pixels, so that the rows' labels fit


def draw(table: Table | Curves, results: PolicyResults | CurveResults, file: Path) -> None:
    """Draw a table.

    Args:
        table: Its definition, with the paper's values.
        results: Its results, see `result_files`.
        file: The picture, a PNG file.
    """
    if isinstance(table, Curves):
        assert isinstance(results, CurveResults)
        chart: alt.TopLevelMixin = _curves(table, results)
    else:
        assert isinstance(results, PolicyResults)
        chart = _table(table, results)
    with atomic_file(file) as unfinished:
        chart.save(str(unfinished), scale_factor=2)


def _table(table: Table, results: PolicyResults) -> alt.LayerChart:
    """The first metric.

    The axis shows the groups, with a mark for each row; a table of one group shows its rows.
    """
    several = len(table.groups) > 1
    ours = list(results.rows if several else _drawn(table, results))
    places = list(table.groups if several else results.rows)
    series = [*ours, *table.paper_values]
    width = max(MIN_WIDTH, STEP * len(places) * (len(series) + 1))
    title = f"{table.title}: mean and 95 % interval"
    if not several:
        title += f" on {table.groups[0]}"
    chart = _marks([*_ours(table, results), *_papers(table)], table, places, ours)
    return chart.properties(width=width, height=300, title=title)


def _marks(points: list[dict], table: Table, places: list[str], ours: list[str]) -> alt.LayerChart:
    """A dot and a line for each of our means and intervals, a diamond for the paper's values."""
    papers = list(table.paper_values)
    series = [*ours, *papers]
    colours = [*COLOURS[: len(ours)], *PAPER_COLOURS[: len(papers)]]
    shapes = ["circle"] * len(ours) + ["diamond"] * len(papers)
    a_word_a_line = alt.Axis(labelAngle=0, labelExpr="split(datum.label, ' ')")
    base = alt.Chart(alt.Data(values=points)).encode(
        x=alt.X("place:N", sort=places, title=table.axis, axis=a_word_a_line),
        xOffset=alt.XOffset("series:N", sort=series, scale=alt.Scale(padding=1)),
        color=alt.Color("series:N", title=None, scale=alt.Scale(domain=series, range=colours)),
    )
    title, scale = AXES[table.metrics[0]], alt.Scale(domain=(0, 1))
    intervals = base.mark_rule(strokeWidth=2).encode(
        y=alt.Y("low:Q", title=title, scale=scale), y2="high:Q"
    )
    means = base.mark_point(filled=True, size=60, opacity=1).encode(
        y=alt.Y("mean:Q", title=title, scale=scale),
        shape=alt.Shape("series:N", title=None, scale=alt.Scale(domain=series, range=shapes)),
    )
    return intervals + means


def _drawn(table: Table, results: PolicyResults) -> dict[str, str]:
    """The metrics of a single group that share the first one's axis, by their label."""
    first = table.metrics[0]
    metrics = [metric for metric in table.metrics if AXES.get(metric) == AXES[first]]
    if len(metrics) > 1:
        return {metric: metric for metric in metrics}
    return {", ".join([*(results.recipes or ()), "our kitchen"]): first}


def _ours(table: Table, results: PolicyResults) -> Iterator[dict]:
    """Our means, each with its place on the axis and its series."""
    for row, of_row in results.rows.items():
        for group, of_group in of_row.groups.items():
            if len(table.groups) > 1:
                first = of_group.metrics[table.metrics[0]]
                yield {"place": group, "series": row, **vars(first)}
            else:
                for series, metric in _drawn(table, results).items():
                    yield {"place": row, "series": series, **vars(of_group.metrics[metric])}


def _papers(table: Table) -> Iterator[dict]:
    """The paper's values, which have no intervals."""
    for series, values in table.paper_values.items():
        for place, value in values.items():
            no_interval = {"mean": value, "low": value, "high": value}
            yield {"place": place, "series": series, **no_interval}


def _curves(curves: Curves, results: CurveResults) -> alt.FacetChart:
    """A panel for each metric: a line with its intervals as a band for each recipe."""
    recipes = list(results.rows)
    colours = alt.Scale(domain=recipes, range=COLOURS[: len(recipes)])
    share = alt.Scale(domain=(0, 1))
    base = alt.Chart().encode(
        x=alt.X("minutes:Q", title="minutes of training", scale=alt.Scale(type="log", nice=False)),
        color=alt.Color("recipe:N", title=None, scale=colours),
    )
    bands = base.mark_area(opacity=0.25).encode(
        y=alt.Y("low:Q", title="mean and 95 % interval on val", scale=share), y2="high:Q"
    )
    means = base.mark_line(point=True).encode(y=alt.Y("mean:Q", scale=share))
    panels = alt.layer(bands, means, data=alt.Data(values=list(_points(curves, results))))
    return panels.properties(width=360, height=300).facet(
        column=alt.Column("metric:N", title=None, sort=list(curves.drawn)), title=curves.title
    )


def _points(curves: Curves, results: CurveResults) -> Iterator[dict]:
    """The checkpoints' means, each with its recipe, metric and training time."""
    for recipe, curve in results.rows.items():
        for point in curve.points:
            minutes = point.seconds / 60
            for metric in curves.drawn:
                interval = point.metrics[metric]
                yield {"recipe": recipe, "metric": metric, "minutes": minutes, **vars(interval)}

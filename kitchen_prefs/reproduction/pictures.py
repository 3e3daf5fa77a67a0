"""The picture of a table: our means with their intervals, and the paper's figures beside them."""

from collections.abc import Iterator
from pathlib import Path

import altair as alt

from kitchen_prefs.files import whole_file
from kitchen_prefs.reproduction.tables import Table

OURS = "our kitchen"
AXES = {
    "PE": "packing efficiency PE (share of the expert's)",
    "Category accuracy": "category accuracy (share of decisions)",
}
# Okabe and Ito's colours, which the colour-blind tell apart; the paper's are black and grey.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#56B4E9", "#CC79A7", "#8A7A2E")
PAPER_COLOURS = ("#000000", "#888888")
STEP = 14  # pixels between marks that stand side by side
LEAST_WIDTH = 560  # pixels, so that names of rows fit


def draw_table(table: Table, facts: dict, file: Path) -> None:
    """Draw the first metric of a table.

    Along the axis stand the groups, with a mark for each row; or the rows, of a single group.

    Args:
        table: What it holds, and the paper's figures.
        facts: What came of it, as `facts` keeps them.
        file: The picture, a PNG file.
    """
    several = len(table.groups) > 1
    ours = list(facts["rows"]) if several else [OURS]
    places = list(table.groups if several else facts["rows"])
    series = [*ours, *table.paper_values]
    width = max(LEAST_WIDTH, STEP * len(places) * (len(series) + 1))
    title = f"{table.title}: mean and 95 % interval"
    if not several:
        title += f" on {table.groups[0]}"
    chart = _marks([*_ours(table, facts), *_papers(table)], table, places, ours)
    with whole_file(file) as beside:
        chart.properties(width=width, height=300, title=title).save(str(beside), scale_factor=2)


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


def _ours(table: Table, facts: dict) -> Iterator[dict]:
    """Our means: where each stands, and in which series."""
    for row, of_row in facts["rows"].items():
        for group, of_group in of_row["groups"].items():
            place, series = (group, row) if len(table.groups) > 1 else (row, OURS)
            yield {"place": place, "series": series, **of_group["metrics"][table.metrics[0]]}


def _papers(table: Table) -> Iterator[dict]:
    """The paper's figures, which come without intervals."""
    for series, values in table.paper_values.items():
        for place, value in values.items():
            no_interval = {"mean": value, "low": value, "high": value}
            yield {"place": place, "series": series, **no_interval}

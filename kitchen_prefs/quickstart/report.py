"""The table and the learning curve of a quickstart."""

from pathlib import Path

import altair as alt

from kitchen_prefs.evaluator import Summary
from kitchen_prefs.files import write_json
from kitchen_prefs.quickstart.training import Logged
from kitchen_prefs.splits import DATA_VERSION

COLUMNS = ("PE", "ED_c", "TE", "Score")


def write_table(summaries: dict[str, dict[str, Summary]], folder: Path) -> str:
    """Write table.md and table.json.

    Args:
        summaries: policy -> split -> summary.
        folder: Where the files go.

    Returns:
        The table as Markdown; a cell is the mean and its 95 % interval.
    """
    header = ["split", "episodes", "policy", *COLUMNS]
    lines = [_row(header), _row(["---"] * len(header))]
    splits = list(next(iter(summaries.values())))
    for split in splits:
        for policy, of_policy in summaries.items():
            summary = of_policy[split]
            cells = [_cell(summary, metric) for metric in COLUMNS]
            lines.append(_row([split, str(summary.episodes), policy, *cells]))
    table = "\n".join(lines) + "\n"
    (folder / "table.md").write_text(f"Data version {DATA_VERSION}.\n\n{table}")
    content = {
        policy: {
            split: {name: vars(interval) for name, interval in summary.metrics.items()}
            for split, summary in of_policy.items()
        }
        for policy, of_policy in summaries.items()
    }
    write_json(folder / "table.json", {"data_version": DATA_VERSION, "policies": content})
    return table


def write_learning_curve(logged: list[Logged], log_freq: int, file: Path) -> None:
    """Draw loss and accuracy over training steps."""
    points = [
        {"step": (i + 1) * log_freq, "value": value, "what": what}
        for i, entry in enumerate(logged)
        for what, value in (("loss", entry.loss), ("accuracy", entry.accuracy))
    ]
    curves = [
        alt.Chart(alt.Data(values=[point for point in points if point["what"] == what]))
        .mark_line(color=colour)
        .encode(
            x=alt.X("step:Q", title="training step"),
            y=alt.Y("value:Q", title=title, scale=alt.Scale(zero=True)),
        )
        .properties(width=380, height=240)
        for what, title, colour in (
            ("loss", "cross-entropy of the expert's choice (nats)", "#b5533c"),
            ("accuracy", "share of choices that are the expert's", "#2f6f73"),
        )
    ]
    alt.hconcat(*curves, title="TTP, recipe ttp_quick, on dishwasher-train-v1").save(
        str(file), scale_factor=2
    )


def _row(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _cell(summary: Summary, metric: str) -> str:
    interval = summary.metrics[metric]
    return f"{interval.mean:.2f} [{interval.low:.2f}, {interval.high:.2f}]"

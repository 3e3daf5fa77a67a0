"""The table and the learning curve of a quickstart."""

from pathlib import Path

import altair as alt

from kitchen_prefs.evaluation.evaluator import Summary
from kitchen_prefs.splits import DATA_VERSION
from kitchen_prefs.utils.files import write_json
from kitchen_prefs_experiments.lerobot_train import LogEntry
from kitchen_prefs_experiments.markdown import interval_cell, markdown_table

COLUMNS = ("PE", "ED_c", "TE", "Score")
COLOURS = {"all decisions": "#b5533c", "pick decisions": "#2f6f73", "place decisions": "#c9a13b"}


def write_table(summaries: dict[str, dict[str, Summary]], folder: Path) -> str:
    """Write table.md and table.json.

    Args:
        summaries: policy -> split -> summary.
        folder: The output folder.

    Returns:
        The table as Markdown; a cell is the mean and its 95 % interval.
    """
    header = ["split", "episodes", "policy", *COLUMNS]
    rows = []
    for split in next(iter(summaries.values())):
        for policy, of_policy in summaries.items():
            summary = of_policy[split]
            cells = [interval_cell(summary.metrics[metric]) for metric in COLUMNS]
            rows.append([split, str(summary.episodes), policy, *cells])
    table = markdown_table(header, rows) + "\n"
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


def write_learning_curve(entries: list[LogEntry], log_freq: int, file: Path) -> None:
    """Draw loss and accuracies over training steps."""
    steps = [(i + 1) * log_freq for i in range(len(entries))]
    loss = {"all decisions": [entry.loss for entry in entries]}
    accuracy = {
        "pick decisions": [entry.pick_accuracy for entry in entries],
        "place decisions": [entry.place_accuracy for entry in entries],
    }
    alt.hconcat(
        _curves(steps, loss, "cross-entropy of the expert's choice (nats)"),
        _curves(steps, accuracy, "share of choices that are the expert's"),
        title="TTP, recipe ttp_quick, on dishwasher-train-v1",
    ).save(str(file), scale_factor=2)


def _curves(steps: list[int], curves: dict[str, list[float]], title: str) -> alt.Chart:
    """One panel, with a curve for each kind of decision."""
    points = [
        {"step": step, "value": value, "decisions": decisions}
        for decisions, values in curves.items()
        for step, value in zip(steps, values, strict=True)
    ]
    colours = alt.Scale(domain=list(COLOURS), range=list(COLOURS.values()))
    return (
        alt.Chart(alt.Data(values=points))
        .mark_line()
        .encode(
            x=alt.X("step:Q", title="training step"),
            y=alt.Y("value:Q", title=title, scale=alt.Scale(zero=True)),
            color=alt.Color("decisions:N", title=None, scale=colours),
        )
        .properties(width=380, height=240)
    )

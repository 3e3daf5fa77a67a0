"""Tables in Markdown."""

from collections.abc import Sequence

from kitchen_prefs.metrics import Interval


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table with a head; every row has as many cells."""
    return "\n".join(f"| {' | '.join(line)} |" for line in (head, ["---"] * len(head), *rows))


def interval_cell(interval: Interval) -> str:
    """A mean and its 95 % interval, as in "0.62 [0.61, 0.64]"."""
    return f"{interval.mean:.2f} [{interval.low:.2f}, {interval.high:.2f}]"

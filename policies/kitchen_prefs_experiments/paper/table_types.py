"""Definitions of the tables: policies, splits, metrics and the paper's values."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kitchen_prefs.splits import get_split
from kitchen_prefs_experiments.paper.evaluated_policies import FineTuning, Policy, Training

# Metrics that are measured on the expert's states.
ACCURACIES = ("Category accuracy", "Pick accuracy")


@dataclass(frozen=True)
class Table:
    """A table of policies and their metrics.

    Its groups are the sets of episodes that a mean is taken over: the splits and, where `by_count`
    holds, the sessions of all of them by their number of dishes per rack.

    Attributes:
        title: Its heading.
        paper: The paper's result.
        axis: The title of the figure's horizontal axis.
        rows: The policies, each with its label.
        splits: The splits they are evaluated on.
        metrics: The metrics that are shown; the first is the one in the figure and in the paper.
        paper_values: The paper's values: label -> group -> value or, in a table of one group,
            label -> row -> value.
        prompt_use: The splits that are also rolled out with another preference's prompt.
        by_count: Whether there is a group for each number of dishes per rack.
        spread: Whether its rows differ in the seed alone, so that their SD is shown.
        note: Differences from the paper.
    """

    title: str
    paper: str
    axis: str
    rows: Mapping[str, Policy]
    splits: tuple[str, ...]
    metrics: tuple[str, ...]
    paper_values: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    prompt_use: tuple[str, ...] = ()
    by_count: bool = False
    spread: bool = False
    note: str = ""

    @property
    def groups(self) -> tuple[str, ...]:
        """The names of the groups, in the order in which they are shown."""
        return (*map(str, self.counts), *self.splits)

    @property
    def counts(self) -> list[int]:
        """The numbers of dishes per rack that have a group."""
        counts = {count for split in self.splits for count in get_split(split).counts}
        return sorted(counts) if self.by_count else []

    @property
    def policies(self) -> list[Policy]:
        """The policies of the rows, each once."""
        return list(dict.fromkeys(self.rows.values()))

    @property
    def trains(self) -> bool:
        """Whether any of its policies has to be trained."""
        return bool(self.recipes)

    @property
    def recipes(self) -> list[str]:
        """The recipes of its trainings, each once."""
        started = [of.start if isinstance(of, FineTuning) else of for of in self.policies]
        return list(dict.fromkeys(of.recipe for of in started if isinstance(of, Training)))

    @property
    def needs_expert_states(self) -> bool:
        """Whether the policies are evaluated on the expert's states, too."""
        return not set(ACCURACIES).isdisjoint(self.metrics)


@dataclass(frozen=True)
class Curves:
    """Learning curves: the metrics of recipes' checkpoints on val, against training time.

    Attributes:
        title: Its heading.
        paper: The paper's result.
        rows: The recipes, each with the earlier recipe whose last checkpoint it continues, if any.
        metrics: The metrics in the results file.
        drawn: The metrics in the figure and on the page.
        note: Differences from the paper.
    """

    title: str
    paper: str
    rows: Mapping[str, str | None]
    metrics: tuple[str, ...]
    drawn: tuple[str, ...]
    note: str = ""

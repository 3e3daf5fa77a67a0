"""What a table of results is: who is evaluated on what, and what the paper says."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from kitchen_prefs.splits import get_split
from kitchen_prefs_experiments.paper.evaluated_policies import FineTuning, Policy, Training

# Asked in the expert's states.
ACCURACIES = ("Category accuracy", "Pick accuracy")


@dataclass(frozen=True)
class Table:
    """A table of policies and their metrics.

    Its groups are the sets of episodes that a mean is taken over: the splits and, where `by_count`
    holds, the sessions of all of them by their number of dishes per rack.

    Attributes:
        title: Its heading.
        paper: What the paper says.
        axis: What stands along the picture's horizontal axis.
        rows: The policies, each with its label.
        splits: The splits they are evaluated on.
        metrics: The metrics that are shown; the first is that of the picture and of the paper.
        paper_values: The paper's figures: what they are called -> group -> value or, in a table of
            one group, -> row -> value.
        prompt_use: The splits that are also rolled out with another preference's prompt.
        by_count: Whether there is a group for each number of dishes per rack.
        note: What is done otherwise than in the paper.
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
        """Whether something has to be trained for it."""
        return bool(self.recipes)

    @property
    def recipes(self) -> list[str]:
        """The recipes of what has to be trained for it, each once."""
        started = [of.start if isinstance(of, FineTuning) else of for of in self.policies]
        return list(dict.fromkeys(of.recipe for of in started if isinstance(of, Training)))

    @property
    def asks_for_accuracy(self) -> bool:
        """Whether the policies are asked in the expert's states, too."""
        return not set(ACCURACIES).isdisjoint(self.metrics)


@dataclass(frozen=True)
class Curves:
    """Learning curves: how good the checkpoints of recipes are on val, against time.

    Attributes:
        title: Its heading.
        paper: What the paper says.
        rows: The recipes, each with the one from whose last checkpoint it goes on, if there is one;
            that one stands before it.
        metrics: The metrics that are kept.
        drawn: Those that are drawn and shown.
        note: What is done otherwise than in the paper.
    """

    title: str
    paper: str
    rows: Mapping[str, str | None]
    metrics: tuple[str, ...]
    drawn: tuple[str, ...]
    note: str = ""

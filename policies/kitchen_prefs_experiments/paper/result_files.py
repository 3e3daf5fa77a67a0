"""The results of a table, docs/results/TABLE.json: the policies and their metrics."""

from importlib.metadata import version
from pathlib import Path
from typing import Self

from pydantic import BaseModel, ConfigDict, ValidationError

from kitchen_prefs.metrics import Interval
from kitchen_prefs.splits import DATA_VERSION
from kitchen_prefs.utils.files import write_json
from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.table_types import Curves


class _Results(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class GroupResults(_Results):
    """The metrics over one group of episodes, such as a split.

    Attributes:
        episodes: The number of episodes.
        metrics: Each metric's mean and its 95 % interval.
    """

    episodes: int
    metrics: dict[str, Interval]


class PolicyDescription(_Results):
    """Which policy was evaluated: a committed checkpoint, a rule, or one that was trained.

    Attributes:
        checkpoint: The name of a committed checkpoint.
        rule: The name of a rule.
        options: The options of lerobot-train that overrode the recipe.
        seconds: The duration of the training's steps (s).
    """

    checkpoint: str | None = None
    rule: str | None = None
    options: list[str] | None = None
    seconds: int | None = None


class PolicyRow(PolicyDescription):
    """A policy and its metrics.

    Attributes:
        policies: The policies of a row of several, which has no description of its own.
        groups: The metrics by split or by number of dishes per rack.
    """

    policies: list[PolicyDescription] | None = None
    groups: dict[str, GroupResults]


class CheckpointResults(_Results):
    """A point of a learning curve.

    Attributes:
        step: The training step at which the checkpoint was saved.
        seconds: The training time until then (s).
        metrics: Each metric on val.
    """

    step: int
    seconds: int
    metrics: dict[str, Interval]


class CurveRow(_Results):
    """The learning curve of a recipe.

    Attributes:
        steps: The number of training steps.
        seconds: Their duration (s).
        best: The step of the best checkpoint by Score on val.
        points: The checkpoints, the earliest first.
    """

    steps: int
    seconds: int
    best: int
    points: list[CheckpointResults]


class _TableResults[Row: PolicyRow | CurveRow](_Results):
    """The results of a table.

    Attributes:
        table: The table's name.
        data_version: The version of the sessions and demonstrations.
        package_version: The version of the package that made them.
        recipes: The recipes that were trained, if any.
        budget: The number of decisions in each training from random weights.
        rows: The results by the rows' labels.
    """

    table: str
    data_version: int
    package_version: str
    recipes: list[str] | None = None
    budget: int | None = None
    rows: dict[str, Row]

    @classmethod
    def of_this_version(
        cls,
        table: str,
        rows: dict[str, Row],
        recipes: list[str] | None = None,
        budget: int | None = None,
    ) -> Self:
        """Results of the installed package."""
        return cls(
            table=table,
            data_version=DATA_VERSION,
            package_version=version("lerobot_policy_kitchen_prefs"),
            recipes=recipes,
            budget=budget,
            rows=rows,
        )


class PolicyResults(_TableResults[PolicyRow]):
    """The results of a table of policies."""


class CurveResults(_TableResults[CurveRow]):
    """The results of a table of learning curves."""


def write_results(results: PolicyResults | CurveResults, folder: Path) -> None:
    """Write FOLDER/TABLE.json."""
    write_json(folder / f"{results.table}.json", results.model_dump(exclude_none=True))


def read_results(folder: Path) -> dict[str, PolicyResults | CurveResults]:
    """Read the results that a folder holds, in the order of `TABLES`.

    Raises:
        ValueError: If a file is damaged.
    """
    files = {name: folder / f"{name}.json" for name in TABLES}
    return {name: _read(file) for name, file in files.items() if file.exists()}


def _read(file: Path) -> PolicyResults | CurveResults:
    results = CurveResults if isinstance(TABLES[file.stem], Curves) else PolicyResults
    try:
        return results.model_validate_json(file.read_bytes())
    except ValidationError as error:
        raise ValueError(
            f"{file} is damaged; `kitchen-prefs reproduce {file.stem}` writes it anew."
        ) from error

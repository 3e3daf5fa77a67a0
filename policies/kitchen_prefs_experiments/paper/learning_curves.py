"""The learning curves of the recipes: each checkpoint's metrics on val, against training time."""

from collections.abc import Iterator
from pathlib import Path

import yaml
from filelock import FileLock

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.evaluation.checkpoint_selection import select_checkpoint
from kitchen_prefs_experiments.lerobot_train import TrainingRun
from kitchen_prefs_experiments.paper.evaluated_policies import BASE
from kitchen_prefs_experiments.paper.result_files import CheckpointResults, CurveResults, CurveRow
from kitchen_prefs_experiments.paper.table_types import Curves
from kitchen_prefs_experiments.recipes import recipe_file

RUNS = Path("outputs")  # ttp_plus.yaml expects the run of ttp_quick there

# The settings of a recipe that change the trained policy; the others concern saving, logging and
# loading.
TRAINING_SETTINGS = ("dataset", "policy", "optimizer", "scheduler", "batch_size", "steps")


def run_curves(name: str, curves: Curves) -> CurveResults:
    """Train the recipes that are not trained yet, and evaluate all their checkpoints on val.

    The run of a recipe is RUNS/RECIPE, and its log RUNS/RECIPE.log. A finished run may have been
    started by any program.

    Args:
        name: The table's name.
        curves: The recipes and metrics.

    Raises:
        ValueError: If a run is not the recipe's, has no log, or is an unfinished one of another
            program; or if its folder holds another run's episodes.
        OSError: If lerobot-train fails; the message names its log.
    """
    for recipe in curves.rows:
        _check(recipe, TrainingRun(RUNS / recipe))
    make_dataset(BASE.dataset)
    rows: dict[str, CurveRow] = {}
    for recipe, start in curves.rows.items():
        earlier = rows[start].seconds if start else 0
        rows[recipe] = _curve(recipe, earlier, curves.metrics)
    return CurveResults.of_this_version(name, rows)


def _check(recipe: str, run: TrainingRun) -> None:
    """Raise a ValueError, before hours of work, if an existing run cannot be used."""
    if not run.is_finished:
        run.check_settings(recipe)
        return
    settings = yaml.safe_load(recipe_file(recipe).read_text())
    expected = {name: settings[name] for name in TRAINING_SETTINGS if name in settings}
    if differing := list(_differing(expected, run.config)):
        raise ValueError(
            f"The run {run.folder} and the recipe {recipe!r} differ in {' and '.join(differing)}; "
            "delete the run or move it elsewhere."
        )
    run.seconds_per_step()  # raises if the log is missing


def _differing(settings: dict, config: dict) -> Iterator[str]:
    """The names of the settings whose value differs in a run's config."""
    for name, value in settings.items():
        if isinstance(value, dict):
            yield from (f"{name}.{one}" for one in _differing(value, config.get(name) or {}))
        elif name != "path" and config.get(name) != value:  # lerobot-train saves no policy.path
            yield name


def _curve(recipe: str, earlier: int, metrics: tuple[str, ...]) -> CurveRow:
    """Evaluate the checkpoints of a recipe; `earlier` seconds of training came before it."""
    run = TrainingRun(RUNS / recipe)
    if not run.is_finished:
        run.train(recipe, log_freq=1, title=recipe)
    seconds_per_step = run.seconds_per_step()
    with FileLock(run.lock):
        selection = select_checkpoint(run.folder)
    points = [
        CheckpointResults(
            step=int(step),
            seconds=round(earlier + int(step) * seconds_per_step),
            metrics={metric: of_step[metric].rounded() for metric in metrics},
        )
        for step, of_step in selection.metrics.items()
    ]
    return CurveRow(
        steps=points[-1].step,
        seconds=points[-1].seconds,
        best=int(selection.best.parent.name),
        points=points,
    )

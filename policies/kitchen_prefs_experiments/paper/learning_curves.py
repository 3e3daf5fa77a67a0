"""The learning curves of the recipes: what each checkpoint is worth on val, and when it came."""

from collections.abc import Iterator
from pathlib import Path

import yaml
from filelock import FileLock

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.evaluation.checkpoint_selection import select_checkpoint
from kitchen_prefs_experiments.paper.result_files import make_facts
from kitchen_prefs_experiments.paper.rows import BASE
from kitchen_prefs_experiments.paper.runs import Run
from kitchen_prefs_experiments.paper.table_types import Curves
from kitchen_prefs_experiments.paper.training import check_settings, run_training
from kitchen_prefs_experiments.recipes import recipe_file

RUNS = Path("outputs")  # where ttp_plus.yaml looks for the run that it goes on from

# What a training becomes depends on these of a recipe's settings; the others say how it is saved,
# logged and loaded.
DECISIVE = ("dataset", "policy", "optimizer", "scheduler", "batch_size", "steps")


def run_curves(name: str, curves: Curves) -> dict:
    """Train the recipes that are not trained yet, and evaluate all their checkpoints on val.

    The run of a recipe is RUNS/RECIPE, and its log RUNS/RECIPE.log. A finished run may be anyone's.

    Args:
        name: The table's name.
        curves: Which recipes, and which metrics.

    Returns:
        The facts, as `facts` keeps them.

    Raises:
        ValueError: If a run is not the recipe's, has no log, or is somebody else's and unfinished;
            or if another run's episodes lie beside it.
        OSError: If lerobot-train fails; the message names its log.
    """
    for recipe in curves.rows:
        _check(recipe, Run(RUNS / recipe))
    make_dataset(BASE.dataset)
    rows: dict[str, dict] = {}
    for recipe, start in curves.rows.items():
        earlier = rows[start]["seconds"] if start else 0
        rows[recipe] = _curve(recipe, earlier, curves.metrics)
    return make_facts(name, rows, {})


def _check(recipe: str, run: Run) -> None:
    """Raise a ValueError, before hours of work, if the run that is there cannot be used."""
    if not run.is_finished:
        check_settings(run, recipe)
        return
    settings = yaml.safe_load(recipe_file(recipe).read_text())
    decisive = {name: settings[name] for name in DECISIVE if name in settings}
    if differing := list(_differing(decisive, run.config)):
        raise ValueError(
            f"The run {run.folder} and the recipe {recipe!r} differ in {' and '.join(differing)}; "
            "delete the run or move it elsewhere."
        )
    run.seconds_a_step()  # raises if the log is missing


def _differing(settings: dict, config: dict) -> Iterator[str]:
    """The settings that lerobot-train was told otherwise."""
    for name, value in settings.items():
        if isinstance(value, dict):
            yield from (f"{name}.{one}" for one in _differing(value, config.get(name) or {}))
        elif name != "path" and config.get(name) != value:  # lerobot-train keeps no policy.path
            yield name


def _curve(recipe: str, earlier: int, metrics: tuple[str, ...]) -> dict:
    """The checkpoints of a recipe, which begins after some seconds of another one."""
    run = Run(RUNS / recipe)
    if not run.is_finished:
        run_training(recipe, run, recipe)
    each = run.seconds_a_step()
    with FileLock(run.lock):
        selection = select_checkpoint(run.folder)
    points = [
        {
            "step": int(step),
            "seconds": round(earlier + int(step) * each),
            "metrics": {metric: of_step[metric].rounded() for metric in metrics},
        }
        for step, of_step in selection.metrics.items()
    ]
    return {
        "steps": points[-1]["step"],
        "seconds": points[-1]["seconds"],
        "best": int(selection.best.parent.name),
        "points": points,
    }

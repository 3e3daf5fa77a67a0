"""Trains through `lerobot-train`, and goes on where a training was stopped."""

import json
import shutil
from collections.abc import Sequence
from pathlib import Path

from filelock import FileLock

from kitchen_prefs.utils.files import write_json
from kitchen_prefs.utils.processes import run_module
from kitchen_prefs_experiments.paper.evaluated_policies import Training
from kitchen_prefs_experiments.paper.runs import Run
from kitchen_prefs_experiments.recipes import recipe_file


def train(training: Training, budget: int, folder: Path, start: Path | None = None) -> Path:
    """Train, unless that is done already; a training that was stopped goes on.

    Args:
        training: What is trained.
        budget: How many decisions it sees.
        folder: Keeps the run.
        start: The checkpoint that it goes on from; if not given, it learns from nothing.

    Returns:
        The checkpoint.

    Raises:
        ValueError: If the folder holds a run with other settings.
        OSError: If lerobot-train fails; the message names the log.
    """
    run = _run_in(folder)
    options = [*training.options(budget), *([f"--policy.path={start}"] if start else [])]
    run_training(training.name, run, training.recipe, options)
    return run.checkpoint


def seconds_of(training: Training, budget: int, folder: Path) -> int:
    """How long the steps of a training took."""
    return round(training.steps(budget) * _run_in(folder).seconds_a_step())


def run_training(name: str, run: Run, recipe: str, options: Sequence[str] = ()) -> None:
    """Run lerobot-train until its last step; a run that was stopped goes on.

    Tables share runs, so whoever asks for one that is under way waits for it.

    Args:
        name: Stands before its bar.
        run: Without a checkpoint it begins anew.
        recipe: The recipe's name.
        options: What lerobot-train is told beside the recipe.

    Raises:
        ValueError: If somebody else began the run, or if it has other settings.
        OSError: If lerobot-train fails; the message names its log.
    """
    run.folder.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(run.lock):
        check_settings(run, recipe, options)
        if run.is_finished:
            return
        if run.checkpoint.exists():
            arguments = [f"--config_path={run.config_file}", "--resume=true"]
        else:
            _clear(run)
            write_json(run.settings, _settings(recipe, options))
            # Every step is logged, so that the shortest run tells how long its steps take.
            arguments = [f"--config_path={recipe_file(recipe)}", *options, "--log_freq=1"]
        arguments.append(f"--output_dir={run.folder}")
        run_module("lerobot.scripts.lerobot_train", arguments, run.log, name)


def check_settings(run: Run, recipe: str, options: Sequence[str] = ()) -> None:
    """Make sure that a run, if it has begun, was begun by `run_training` with these settings.

    Raises:
        ValueError: If it was not.
    """
    if not run.folder.exists():
        return
    if not run.settings.exists():
        raise ValueError(
            f"{run.folder} is a run that `kitchen-prefs reproduce` did not begin; let it finish or "
            "delete it."
        )
    if json.loads(run.settings.read_text()) != _settings(recipe, options):
        raise ValueError(
            f"{run.folder} is a run of another recipe or with other settings; delete it or move it "
            "elsewhere."
        )


def _run_in(folder: Path) -> Run:
    return Run(folder / "train")


def _settings(recipe: str, options: Sequence[str]) -> dict[str, list[str]]:
    lines = recipe_file(recipe).read_text().splitlines()
    code = [line.partition("#")[0].rstrip() for line in lines]  # a comment changes nothing
    return {"recipe": [line for line in code if line], "options": list(options)}


def _clear(run: Run) -> None:
    """Delete what is left of a run that was stopped before its first checkpoint, or deleted."""
    shutil.rmtree(run.folder, ignore_errors=True)
    run.log.unlink(missing_ok=True)

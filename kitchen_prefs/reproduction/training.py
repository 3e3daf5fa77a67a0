"""Trains through `lerobot-train`, and goes on where a training was stopped."""

import json
import re
import shutil
from pathlib import Path
from statistics import mean

from kitchen_prefs.files import write_json
from kitchen_prefs.recipes import recipe_file
from kitchen_prefs.reproduction.policies import RECIPE, Training
from kitchen_prefs.reproduction.processes import run_module

SECONDS = re.compile(r"updt_s:(\S+) data_s:(\S+)")
LOG = "train.log"


def train(training: Training, budget: int, folder: Path) -> Path:
    """Train, unless that is done already; a training that was stopped goes on.

    Args:
        training: What is trained.
        budget: How many decisions it sees.
        folder: The folder of the run; the log is written there, too.

    Returns:
        The checkpoint.

    Raises:
        ValueError: If the folder holds a run with other settings.
        OSError: If lerobot-train fails; the message names the log.
    """
    folder.mkdir(parents=True, exist_ok=True)
    _check_settings(folder, training.options(budget))
    run = folder / "train"
    checkpoint = run / "checkpoints" / "last" / "pretrained_model"
    if _steps_done(checkpoint) < training.steps(budget):
        if checkpoint.exists():
            arguments = [f"--config_path={checkpoint / 'train_config.json'}", "--resume=true"]
        else:
            shutil.rmtree(run, ignore_errors=True)
            arguments = [f"--config_path={recipe_file(RECIPE)}", *training.options(budget)]
        # Every step is logged, so that the shortest run tells how long its steps take.
        arguments += [f"--output_dir={run}", "--log_freq=1"]
        run_module("lerobot.scripts.lerobot_train", arguments, folder / LOG, training.name)
    return checkpoint


def seconds_of(training: Training, budget: int, folder: Path) -> int:
    """How long the steps of a training took: the mean of those in the log, times their number.

    So what was trained twice, because a training was stopped between two checkpoints, counts once.
    """
    each = SECONDS.findall((folder / LOG).read_text())
    return round(training.steps(budget) * mean(float(step) + float(data) for step, data in each))


def _check_settings(folder: Path, options: list[str]) -> None:
    """Keep a run's settings beside it, and raise a ValueError if it has other ones already."""
    lines = recipe_file(RECIPE).read_text().splitlines()
    code = [line.partition("#")[0].rstrip() for line in lines]  # a comment changes nothing
    settings = {"recipe": [line for line in code if line], "options": options}
    file = folder / "settings.json"
    if not file.exists():
        write_json(file, settings)
    elif json.loads(file.read_text()) != settings:
        raise ValueError(
            f"{folder} holds a run of another recipe or with other settings; delete it, or give "
            "another --out."
        )


def _steps_done(checkpoint: Path) -> int:
    state = checkpoint.parent / "training_state" / "training_step.json"
    return json.loads(state.read_text())["step"] if state.exists() else 0

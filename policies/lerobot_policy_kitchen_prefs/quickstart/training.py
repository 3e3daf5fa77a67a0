"""Runs `lerobot-train` on a recipe and reads its log."""

import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from lerobot_policy_kitchen_prefs.recipe_files import recipe_file

PROGRESS = re.compile(r"Training: .*?(\d+)/(\d+) ")
LOGGED = re.compile(r"step:\S+ .*?loss:([\d.]+).*?updt_s:([\d.]+) data_s:([\d.]+)")
ACCURACY = re.compile(r"accuracy:([\d.]+)")


@dataclass(frozen=True)
class Logged:
    """What lerobot-train logged of some steps.

    Attributes:
        loss: Mean loss.
        update_s: Seconds of a step's update.
        data_s: Seconds of a step's data.
        accuracy: Share of decisions in which the policy's first choice is the expert's.
    """

    loss: float
    update_s: float
    data_s: float
    accuracy: float


def train(recipe: str, run: Path) -> Path:
    """Train a recipe through `lerobot-train`, or go on where an earlier run was stopped.

    Args:
        recipe: The recipe's name.
        run: The output folder; the log is written beside it.

    Returns:
        The checkpoint.

    Raises:
        OSError: If lerobot-train fails; the message names the log.
    """
    checkpoint = run / "checkpoints" / "last" / "pretrained_model"
    config = checkpoint / "train_config.json"
    command = [sys.executable, "-m", "lerobot.scripts.lerobot_train"]
    if config.exists():
        command += [f"--config_path={config}", "--resume=true"]
    else:
        command += [f"--config_path={recipe_file(recipe)}", f"--output_dir={run}"]
    log = run.with_suffix(".log")
    log.parent.mkdir(parents=True, exist_ok=True)
    if _run(command, log) != 0:
        raise OSError(f"lerobot-train failed; the end of {log} says why.")
    return checkpoint


def read_log(run: Path) -> list[Logged]:
    """What lerobot-train logged, one entry each `log_freq` steps."""
    found = []
    for line in run.with_suffix(".log").read_text().splitlines():
        if values := LOGGED.search(line):
            accuracy = ACCURACY.search(line)
            loss, update_s, data_s = (float(value) for value in values.groups())
            found.append(
                Logged(loss, update_s, data_s, float(accuracy.group(1)) if accuracy else 0.0)
            )
    return found


def _run(command: list[str], log: Path) -> int:
    """Run a command with a bar that follows lerobot-train's own; its words go to the log."""
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace"
    )
    assert process.stdout is not None
    with log.open("a") as file, tqdm(desc="lerobot-train", unit="step") as bar:
        for line in process.stdout:  # a carriage return ends a line too
            if progress := PROGRESS.search(line):
                bar.total = int(progress.group(2))
                bar.update(int(progress.group(1)) - bar.n)
            else:
                file.write(line)
    return process.wait()

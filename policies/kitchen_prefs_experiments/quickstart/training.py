"""Runs `lerobot-train` on a recipe and reads its log."""

import json
import re
import shutil
import sys
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from kitchen_prefs.utils.processes import start
from kitchen_prefs_experiments.recipes import recipe_file

PROGRESS = re.compile(r"Training: .*?(\d+)/(\d+) \[.*?\]")
LOGGED = re.compile(r"step:\S+ .*?loss:(\S+) .*?pick_accuracy:(\S+) place_accuracy:(\S+)")


@dataclass(frozen=True)
class Logged:
    """What lerobot-train logged: means over the last `log_freq` steps.

    Attributes:
        loss: Cross-entropy of the expert's choices (nats).
        pick_accuracy: Share of pick decisions in which the highest score is the expert's choice.
        place_accuracy: The same of place decisions.
    """

    loss: float
    pick_accuracy: float
    place_accuracy: float


def train(recipe: str, run: Path) -> Path:
    """Train a recipe through `lerobot-train`, unless that is done already.

    A training that was stopped begins anew.

    Args:
        recipe: The recipe's name.
        run: The output folder; the log is written beside it.

    Returns:
        The checkpoint.

    Raises:
        OSError: If lerobot-train fails; the message names the log.
    """
    checkpoint = run / "checkpoints" / "last" / "pretrained_model"
    if not _is_finished(checkpoint):
        shutil.rmtree(run, ignore_errors=True)
        run.parent.mkdir(parents=True, exist_ok=True)
        log = run.with_suffix(".log")
        arguments = [f"--config_path={recipe_file(recipe)}", f"--output_dir={run}"]
        if _run([sys.executable, "-m", "lerobot.scripts.lerobot_train", *arguments], log) != 0:
            raise OSError(f"lerobot-train failed; the end of {log} says why.")
    return checkpoint


def read_log(run: Path) -> list[Logged]:
    """What lerobot-train logged, one entry each `log_freq` steps."""
    found = LOGGED.findall(run.with_suffix(".log").read_text())
    return [Logged(*map(float, numbers)) for numbers in found]


def _is_finished(checkpoint: Path) -> bool:
    """Whether a run's last checkpoint was saved at its last step."""
    state = checkpoint.parent / "training_state" / "training_step.json"
    if not state.exists():
        return False
    config = json.loads((checkpoint / "train_config.json").read_text())
    return json.loads(state.read_text())["step"] == config["steps"]


def _run(command: list[str], log: Path) -> int:
    """Run a command with a bar that follows lerobot-train's own; its words go to the log."""
    process = start(command)
    assert process.stdout is not None
    with log.open("w") as file, tqdm(desc="lerobot-train", unit="step") as bar:
        for line in process.stdout:  # a carriage return ends a line too
            if progress := PROGRESS.search(line):
                bar.total = int(progress.group(2))
                bar.update(int(progress.group(1)) - bar.n)
            if said := PROGRESS.sub("", line).strip():  # what is logged follows on the bar's line
                print(said, file=file, flush=True)
    return process.wait()

"""Runs `lerobot-train` on a recipe: starts a run, resumes it, and reads what it wrote.

RUN/checkpoints/last/pretrained_model/   the last checkpoint, with all settings of the run
RUN/checkpoints/last/training_state/     the step at which it was saved
RUN.log                                  lerobot-train's output, without its progress bar
RUN.json                                 the recipe and the options that the run was started with
RUN.lock                                 held by the process that trains or evaluates the run
"""

import json
import re
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean

from filelock import FileLock

from kitchen_prefs.utils.files import write_json
from kitchen_prefs.utils.processes import run_module
from kitchen_prefs_experiments.recipes import recipe_file

STEP_SECONDS = re.compile(r"updt_s:(\S+) data_s:(\S+)")
LOG_ENTRY = re.compile(r"step:\S+ .*?loss:(\S+) .*?pick_accuracy:(\S+) place_accuracy:(\S+)")


@dataclass(frozen=True)
class LogEntry:
    """Means over the steps between two lines of the log.

    Attributes:
        loss: Cross-entropy of the expert's choices (nats).
        pick_accuracy: Share of pick decisions in which the highest score is the expert's choice.
        place_accuracy: The same for place decisions.
    """

    loss: float
    pick_accuracy: float
    place_accuracy: float


@dataclass(frozen=True)
class TrainingRun:
    """A run of lerobot-train, which may not have started yet.

    Attributes:
        folder: Its output folder.
    """

    folder: Path

    @property
    def log(self) -> Path:
        """The output of lerobot-train, from the first start and all resumptions."""
        return self.folder.with_suffix(".log")

    @property
    def settings_file(self) -> Path:
        """The settings that `train` started the run with; nothing else writes such a file."""
        return self.folder.with_suffix(".json")

    @property
    def lock(self) -> Path:
        """The file whose lock keeps a second process from working on the run."""
        return self.folder.with_suffix(".lock")

    @property
    def checkpoint(self) -> Path:
        """The last checkpoint."""
        return self.folder / "checkpoints" / "last" / "pretrained_model"

    @property
    def config_file(self) -> Path:
        """All settings of the run, as lerobot-train keeps them in the last checkpoint."""
        return self.checkpoint / "train_config.json"

    @property
    def config(self) -> dict:
        """The content of `config_file`."""
        return json.loads(self.config_file.read_text())

    @property
    def is_finished(self) -> bool:
        """Whether the last checkpoint was saved at the last step."""
        state = self.checkpoint.parent / "training_state" / "training_step.json"
        return state.exists() and json.loads(state.read_text())["step"] == self.config["steps"]

    def train(
        self,
        recipe: str,
        options: Sequence[str] = (),
        *,
        log_freq: int | None = None,
        title: str = "lerobot-train",
    ) -> None:
        """Train until the last step; a run that was stopped resumes from its last checkpoint.

        Tables may share a run: a second process waits until the first has finished it.

        Args:
            recipe: The recipe's name.
            options: Options of lerobot-train that override the recipe.
            log_freq: Steps between two lines of the log; if not given, the recipe's.
            title: The label of the progress bar.

        Raises:
            ValueError: If the run was started by another program or with other settings.
            OSError: If lerobot-train fails; the message names its log.
        """
        self.folder.parent.mkdir(parents=True, exist_ok=True)
        with FileLock(self.lock):
            self.check_settings(recipe, options)
            if self.is_finished:
                return
            if self.checkpoint.exists():
                arguments = [f"--config_path={self.config_file}", "--resume=true"]
            else:
                self.delete()
                write_json(self.settings_file, _settings(recipe, options))
                arguments = [f"--config_path={recipe_file(recipe)}", *options]
                if log_freq is not None:  # no setting, because it does not change the training
                    arguments.append(f"--log_freq={log_freq}")
            arguments.append(f"--output_dir={self.folder}")
            run_module("lerobot.scripts.lerobot_train", arguments, self.log, title)

    def check_settings(self, recipe: str, options: Sequence[str] = ()) -> None:
        """Check that the run, if it has started, was started by `train` with these settings.

        Raises:
            ValueError: If it was not.
        """
        if not self.folder.exists():
            return
        if not self.settings_file.exists():
            raise ValueError(
                f"{self.folder} is a run of another program; let it finish or delete it, or give "
                "another folder."
            )
        if json.loads(self.settings_file.read_text()) != _settings(recipe, options):
            raise ValueError(
                f"{self.folder} is a run of another recipe or with other settings; delete it or "
                "move it elsewhere."
            )

    def delete(self) -> None:
        """Delete the run and its log, so that it starts from the beginning."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self.log.unlink(missing_ok=True)

    def log_entries(self) -> list[LogEntry]:
        """The losses and accuracies in the log, in the order of the steps."""
        return [LogEntry(*map(float, found)) for found in LOG_ENTRY.findall(self.log.read_text())]

    def seconds_per_step(self) -> float:
        """The mean duration of a step over the log, data loading included (s).

        Steps that were trained twice, because the run was stopped between two checkpoints, do not
        count twice.

        Raises:
            ValueError: If there is no log, or no durations in it.
        """
        steps = STEP_SECONDS.findall(self.log.read_text()) if self.log.exists() else []
        if not steps:
            raise ValueError(
                f"{self.log} holds no durations of steps; put the log of lerobot-train "
                f"there, or delete {self.folder} to train anew."
            )
        return mean(float(update) + float(data) for update, data in steps)


def _settings(recipe: str, options: Sequence[str]) -> dict[str, list[str]]:
    lines = recipe_file(recipe).read_text().splitlines()
    code = [line.partition("#")[0].rstrip() for line in lines]  # a comment changes nothing
    return {"recipe": [line for line in code if line], "options": list(options)}

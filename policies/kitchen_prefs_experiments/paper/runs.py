"""A run of lerobot-train: its folder, and the log, the settings and the lock beside it."""

import json
import re
from dataclasses import dataclass
from pathlib import Path
from statistics import mean

SECONDS = re.compile(r"updt_s:(\S+) data_s:(\S+)")


@dataclass(frozen=True)
class Run:
    """A run of lerobot-train, which may not have begun yet.

    Attributes:
        folder: Its output folder.
    """

    folder: Path

    @property
    def log(self) -> Path:
        """What lerobot-train said."""
        return self.folder.with_suffix(".log")

    @property
    def settings(self) -> Path:
        """What `kitchen-prefs reproduce` began it with; nobody else writes such a file."""
        return self.folder.with_suffix(".json")

    @property
    def lock(self) -> Path:
        """Whoever works on the run holds it."""
        return self.folder.with_suffix(".lock")

    @property
    def checkpoint(self) -> Path:
        """The last checkpoint."""
        return self.folder / "checkpoints" / "last" / "pretrained_model"

    @property
    def config_file(self) -> Path:
        """All that lerobot-train was told, as it keeps it in the last checkpoint."""
        return self.checkpoint / "train_config.json"

    @property
    def config(self) -> dict:
        """What `config_file` says."""
        return json.loads(self.config_file.read_text())

    @property
    def is_finished(self) -> bool:
        """Whether the last checkpoint was saved at the last step."""
        state = self.checkpoint.parent / "training_state" / "training_step.json"
        return state.exists() and json.loads(state.read_text())["step"] == self.config["steps"]

    def seconds_a_step(self) -> float:
        """How long a step took, the mean over the log.

        So what was trained twice, because a training was stopped between two checkpoints, counts
        once.

        Raises:
            ValueError: If there is no log, or nothing in it.
        """
        each = SECONDS.findall(self.log.read_text()) if self.log.exists() else []
        if not each:
            raise ValueError(
                f"{self.log} does not say how long the steps took; put the log of lerobot-train "
                f"there, or delete {self.folder} to train anew."
            )
        return mean(float(step) + float(data) for step, data in each)

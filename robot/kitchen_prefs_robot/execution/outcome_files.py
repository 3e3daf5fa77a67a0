"""The outcomes of a variation, a line each, so that a table resumes where it was stopped."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.outcomes import COUNTING, EpisodeOutcome
from kitchen_prefs_robot.execution.trials import VARIATIONS, Trial


@dataclass(frozen=True)
class OutcomeFile:
    """The outcomes of one policy under one variation.

    Each line says what it was made with, so that nothing else is ever counted beside it.

    Attributes:
        folder: The table's folder.
        variation: A row of the table.
        fingerprint: The policy's.
    """

    folder: Path
    variation: str
    fingerprint: str

    @property
    def path(self) -> Path:
        """The file."""
        name = self.variation.replace(" ", "_").replace("%", "percent")
        return self.folder / f"{name}.jsonl"

    @property
    def conditions(self) -> Conditions:
        """What the variation leaves to the robot."""
        return VARIATIONS[self.variation]

    def read(self) -> dict[Trial, EpisodeOutcome]:
        """The outcomes that are there; a line that was cut off counts as not there.

        Raises:
            ValueError: If there is a line of another policy, of other conditions, of another way of
                counting, or of something else.
        """
        found: dict[Trial, EpisodeOutcome] = {}
        for line in self.path.read_text().splitlines() if self.path.exists() else ():
            try:
                content = json.loads(line)
            except ValueError:
                continue
            self._check(content)
            try:
                found[Trial(**content["trial"])] = EpisodeOutcome(**content["outcome"])
            except (KeyError, TypeError) as error:
                raise self._refused("lines that are no outcomes") from error
        return found

    def add(self, trial: Trial, outcome: EpisodeOutcome) -> None:
        """Add an outcome, on a line of its own even after one that was cut off."""
        line = self._made_with | {"trial": asdict(trial), "outcome": asdict(outcome)}
        cut_off = self.path.exists() and not self.path.read_text().endswith("\n")
        with self.path.open("a") as lines:
            lines.write("\n" * cut_off + f"{json.dumps(line)}\n")

    @property
    def _made_with(self) -> dict[str, Any]:
        """What each line begins with."""
        return {
            "policy": self.fingerprint,
            "conditions": asdict(self.conditions),
            "counting": COUNTING,
        }

    def _check(self, content: Any) -> None:
        """Refuse a line that was made with something else."""
        if not isinstance(content, dict) or "policy" not in content:
            raise self._refused("lines that are no outcomes")
        others = {
            "policy": "outcomes of another policy",
            "counting": "outcomes that were counted in another way",
            "conditions": "outcomes of other conditions",
        }
        for key, sentence in others.items():
            if content.get(key) != self._made_with[key]:
                raise self._refused(sentence)

    def _refused(self, what: str) -> ValueError:
        return ValueError(f"{self.path} has {what}; give another --out.")

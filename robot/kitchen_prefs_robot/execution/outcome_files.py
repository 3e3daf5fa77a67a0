"""The outcomes of a variation, a line each, so that a table resumes where it was stopped."""

import json
from dataclasses import asdict
from pathlib import Path

from kitchen_prefs_robot.execution.outcomes import EpisodeOutcome
from kitchen_prefs_robot.execution.trials import Trial


def read_outcomes(folder: Path, variation: str, fingerprint: str) -> dict[Trial, EpisodeOutcome]:
    """The outcomes of a policy that are there; a line that was cut off counts as not there.

    Raises:
        ValueError: If they are another policy's.
    """
    file = outcome_file(folder, variation)
    found: dict[Trial, EpisodeOutcome] = {}
    for line in file.read_text().splitlines() if file.exists() else ():
        try:
            content = json.loads(line)
        except ValueError:
            continue
        if content["policy"] != fingerprint:
            raise ValueError(f"{file} has outcomes of another policy; give another --out.")
        found[Trial(**content["trial"])] = EpisodeOutcome(**content["outcome"])
    return found


def write_outcome(
    folder: Path, variation: str, fingerprint: str, trial: Trial, outcome: EpisodeOutcome
) -> None:
    """Add an outcome, on a line of its own even after one that was cut off."""
    line = {"policy": fingerprint, "trial": asdict(trial), "outcome": asdict(outcome)}
    file = outcome_file(folder, variation)
    cut_off = file.exists() and not file.read_text().endswith("\n")
    with file.open("a") as lines:
        lines.write("\n" * cut_off + f"{json.dumps(line)}\n")


def outcome_file(folder: Path, variation: str) -> Path:
    """Where the outcomes of a variation are."""
    return folder / f"{variation.replace(' ', '_').replace('%', 'percent')}.jsonl"

"""Policies that are ready to be played: trained where they have to be."""

from dataclasses import dataclass
from pathlib import Path

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs_experiments.paper.evaluated_policies import (
    Committed,
    FineTuning,
    Policy,
    Rule,
    Training,
    numbered,
)
from kitchen_prefs_experiments.paper.training import seconds_of, train


@dataclass(frozen=True)
class Player:
    """What `kitchen-prefs evaluate` plays.

    Attributes:
        source: Its options that say which policy it is.
        folder: Keeps the work on it.
        facts: Which policy it is, as `facts` keeps it.
        preference: The label of the preference whose sessions alone count; None for all.
    """

    source: list[str]
    folder: Path
    facts: dict
    preference: int | None = None

    @property
    def episodes(self) -> Path:
        """The folder of its episodes."""
        return self.folder / "evaluation"


def prepare(policy: Policy, budget: int) -> None:
    """Make the data, find the checkpoint: what is missing is said before hours of work.

    Raises:
        ValueError: If a checkpoint is not there, or if the budget is too small.
        OSError: If the data cannot be written.
    """
    match policy:
        case Training():
            policy.steps(budget)
            make_dataset(policy.dataset)
        case FineTuning():
            prepare(policy.start, budget)
            for training in policy.trainings:
                make_dataset(training.dataset)
        case Committed():
            policy.find()


def players_of(policy: Policy, budget: int, out: Path) -> list[Player]:
    """Train what a policy needs and is not there yet; a fine-tuning becomes several players.

    Raises:
        ValueError: If a checkpoint is not there, or if `out` holds another policy's work.
        OSError: If a training fails; the message names its log.
    """
    trained = out / str(budget)
    match policy:
        case Training():
            return [_trained(policy, budget, trained / policy.name)]
        case FineTuning():
            folder = trained / policy.start.name
            start = train(policy.start, budget, folder)
            return [
                _trained(one, policy.budget, folder / policy.name / one.name, start)
                for one in policy.trainings
            ]
        case Committed():
            source = [f"--policy.path={policy.find()}", f"--prompts={policy.prompts}"]
            folder = out / "checkpoints" / numbered(policy.name, policy.prompts)
            return [Player(source, folder, {"checkpoint": policy.name})]
        case Rule():
            source = ["--policy.type=rules", f"--policy.rule={policy.name}"]
            source.append(f"--prompts={policy.prompts}")
            folder = out / "rules" / numbered(policy.name, policy.prompts)
            return [Player(source, folder, {"rule": policy.name})]


def _trained(training: Training, budget: int, folder: Path, start: Path | None = None) -> Player:
    source = [f"--policy.path={train(training, budget, folder, start)}"]
    seconds = seconds_of(training, budget, folder)
    facts = {"options": training.options(budget), "seconds": seconds}
    return Player(source, folder, facts, training.preference)

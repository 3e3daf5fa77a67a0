"""Policies that are ready to be evaluated: trained where they have to be."""

from dataclasses import dataclass
from pathlib import Path

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs_experiments.lerobot_train import TrainingRun
from kitchen_prefs_experiments.paper.evaluated_policies import (
    Committed,
    FineTuning,
    Policy,
    Rule,
    Training,
    numbered,
)
from kitchen_prefs_experiments.paper.result_files import PolicyDescription


@dataclass(frozen=True)
class PreparedPolicy:
    """A policy that `kitchen-prefs evaluate` can load.

    Attributes:
        options: The options of `evaluate` that name it.
        folder: Keeps its run and its episodes.
        description: What the results say of it.
        preference: The label of the preference whose sessions alone count; None for all.
    """

    options: list[str]
    folder: Path
    description: PolicyDescription
    preference: int | None = None

    @property
    def episodes(self) -> Path:
        """The folder of its episodes."""
        return self.folder / "evaluation"


def check(policy: Policy, budget: int) -> None:
    """Make the data and find the checkpoint, so that what is missing shows before hours of work.

    Raises:
        ValueError: If a checkpoint is not there, or if the budget is too small.
        OSError: If the data cannot be written.
    """
    match policy:
        case Training():
            policy.steps(budget)
            make_dataset(policy.dataset)
        case FineTuning():
            check(policy.start, budget)
            for training in policy.trainings:
                make_dataset(training.dataset)
        case Committed():
            policy.find()


def prepare(policy: Policy, budget: int, out: Path) -> list[PreparedPolicy]:
    """Train what a policy needs and is not there yet; a fine-tuning becomes several policies.

    Args:
        policy: The policy of a table's row.
        budget: How many decisions each training sees.
        out: Keeps the runs and the episodes.

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
            start = train(policy.start, budget, folder).checkpoint
            return [
                _trained(one, policy.budget, folder / policy.name / one.name, start)
                for one in policy.trainings
            ]
        case Committed():
            options = [f"--policy.path={policy.find()}", f"--prompts={policy.prompts}"]
            folder = out / "checkpoints" / numbered(policy.name, policy.prompts)
            return [PreparedPolicy(options, folder, PolicyDescription(checkpoint=policy.name))]
        case Rule():
            options = ["--policy.type=rules", f"--policy.rule={policy.name}"]
            options.append(f"--prompts={policy.prompts}")
            folder = out / "rules" / numbered(policy.name, policy.prompts)
            return [PreparedPolicy(options, folder, PolicyDescription(rule=policy.name))]


def train(training: Training, budget: int, folder: Path, start: Path | None = None) -> TrainingRun:
    """Train, unless that is done already; a training that was stopped resumes.

    Args:
        training: The recipe, the data and the overridden settings.
        budget: How many decisions it sees.
        folder: Keeps the run.
        start: The checkpoint whose weights it begins with; if not given, it begins with random
            ones.

    Raises:
        ValueError: If the folder holds a run with other settings.
        OSError: If lerobot-train fails; the message names the log.
    """
    run = TrainingRun(folder / "train")
    options = [*training.options(budget), *([f"--policy.path={start}"] if start else [])]
    # Every step is logged, so that even the shortest run says how long its steps take.
    run.train(training.recipe, options, log_freq=1, title=training.name)
    return run


def _trained(
    training: Training, budget: int, folder: Path, start: Path | None = None
) -> PreparedPolicy:
    run = train(training, budget, folder, start)
    seconds = round(training.steps(budget) * run.seconds_per_step())
    description = PolicyDescription(options=training.options(budget), seconds=seconds)
    return PreparedPolicy(
        [f"--policy.path={run.checkpoint}"], folder, description, training.preference
    )

"""Prepares policies for evaluation: trains those that need it."""

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
        folder: The folder of its run and its episodes.
        description: Its description in the results.
        preference: The label of the only preference whose sessions count; None for all.
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
    """Make the data and find the checkpoint, so that errors come before hours of work.

    Raises:
        ValueError: If a checkpoint is missing, or if the budget is too small.
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
    """Train a policy where that is needed; a fine-tuning becomes several policies.

    Args:
        policy: The policy of a table's row.
        budget: The number of decisions in each training.
        out: The folder of the runs and the episodes.

    Raises:
        ValueError: If a checkpoint is missing, or if `out` holds runs with other settings.
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
    """Train, unless that is finished; a training that was stopped resumes.

    Args:
        training: The recipe, the data and the overridden settings.
        budget: The number of decisions.
        folder: The folder of the run.
        start: The checkpoint with the initial weights; if not given, they are random.

    Raises:
        ValueError: If the folder holds a run with other settings.
        OSError: If lerobot-train fails; the message names the log.
    """
    run = TrainingRun(folder / "train")
    options = [*training.options(budget), *([f"--policy.path={start}"] if start else [])]
    # Every step is logged, so that even the shortest run has durations of steps.
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

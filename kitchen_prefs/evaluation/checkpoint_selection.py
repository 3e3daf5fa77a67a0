"""Selects the best checkpoint of a training run: the one with the highest headline on val."""

from dataclasses import asdict, dataclass
from pathlib import Path

from kitchen_prefs.evaluation.evaluator import Evaluator
from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.evaluation.rollouts import BATCH_SIZE
from kitchen_prefs.evaluation.tiers import TIERS, tier_of
from kitchen_prefs.metrics import Interval
from kitchen_prefs.utils.files import write_json


@dataclass(frozen=True)
class Selection:
    """The evaluated checkpoints of a run.

    Attributes:
        best: The folder of the best checkpoint; on a tie, the earliest.
        metrics: Each checkpoint's metrics on val, by its step.
    """

    best: Path
    metrics: dict[str, dict[str, Interval]]


def select_checkpoint(
    run: Path,
    *,
    split: str = "val",
    track: str | None = None,
    batch_size: int = BATCH_SIZE,
) -> Selection:
    """Evaluate a run's checkpoints on val and write RUN/selection.json.

    The episodes are kept in RUN/selection, so a selection that was killed resumes.

    Args:
        run: The output folder of `lerobot-train` or `kitchen-prefs reinforce`.
        split: Where they are evaluated: val, or people_val of the second tier.
        track: What the policy observes; if not given, the track of its settings.
        batch_size: How many sessions are rolled out at once.

    Raises:
        ValueError: If the run has no checkpoints, or if the split is not for choosing.
    """
    tier = tier_of(split)
    if split != tier.val:
        choices = " or ".join(f"--split={one.val}" for one in TIERS.values())
        raise ValueError(f"No checkpoint is chosen on {split}; give {choices}.")
    folders = {
        folder.parent.name: folder
        for folder in sorted(run.glob("checkpoints/*/pretrained_model"))
        if folder.parent.name.isdigit()  # the link "last" names one of them again
    }
    if not folders:
        raise ValueError(f"{run} holds no checkpoints; give the output folder of a training.")
    metrics = {}
    for step, folder in folders.items():
        loaded_policy = load_policy(str(folder), track=track, split=split)
        evaluator = Evaluator(loaded_policy, run / "selection" / step, batch_size=batch_size)
        metrics[step] = evaluator.evaluate(split).metrics
    best = max(folders, key=lambda step: metrics[step][tier.headline].mean)
    content = {
        "best": str(folders[best].relative_to(run)),
        "split": split,
        "checkpoints": {
            step: {name: asdict(interval) for name, interval in of_step.items()}
            for step, of_step in metrics.items()
        },
    }
    write_json(run / "selection.json", content)
    return Selection(folders[best], metrics)

"""What a table evaluates: committed checkpoints, rules, and trainings of a recipe."""

from dataclasses import dataclass
from pathlib import Path

from kitchen_prefs.recipes import recipe_file
from kitchen_prefs.splits import DATA_VERSION

RECIPE = "ttp_quick"  # what every training starts from: it learns from nothing in minutes


@dataclass(frozen=True)
class Committed:
    """A checkpoint that the repository holds, `policies/checkpoints/<name>`.

    Attributes:
        name: Names the checkpoint.
        prompts: How many demonstrations prompt an episode.
    """

    name: str
    prompts: int = 1

    def find(self) -> Path:
        """Its folder, beside the recipes.

        Raises:
            ValueError: If it is not there.
        """
        folder = recipe_file(RECIPE).parents[1] / "checkpoints" / self.name
        if not folder.is_dir():
            raise ValueError(
                f"There is no checkpoint {self.name!r} yet; train the recipe {self.name!r} and put "
                f"the best checkpoint's pretrained_model at {folder}."
            )
        return folder


@dataclass(frozen=True)
class Rule:
    """A rule of the policy type "rules", which needs no training.

    Attributes:
        name: Names the rule.
        prompts: How many demonstrations prompt an episode.
    """

    name: str
    prompts: int = 1


@dataclass(frozen=True)
class Training:
    """A training of the recipe `RECIPE` with some settings overridden.

    Attributes:
        name: Names the run's folder, so trainings with one name are one training.
        dataset: What it is trained on.
        batch_size: How many decisions a step sees.
        overrides: Further options of lerobot-train.
    """

    name: str
    dataset: str = f"dishwasher-train-v{DATA_VERSION}"
    batch_size: int = 32  # the recipe's
    overrides: tuple[str, ...] = ()

    def steps(self, budget: int) -> int:
        """How many steps see `budget` decisions.

        Raises:
            ValueError: If it is not one step.
        """
        if budget < self.batch_size:
            raise ValueError(
                f"A budget of {budget} decisions is not one batch of {self.batch_size}; give a "
                "greater --budget."
            )
        return budget // self.batch_size

    def options(self, budget: int) -> list[str]:
        """What lerobot-train is told beside the recipe, for a budget of decisions."""
        return [
            f"--dataset.repo_id=kitchen_prefs/{self.dataset}",
            f"--batch_size={self.batch_size}",
            f"--steps={self.steps(budget)}",
            *self.overrides,
        ]


def numbered(name: str, prompts: int) -> str:
    """The name of a policy with its number of prompts, if that is not one."""
    return name if prompts == 1 else f"{name}-{prompts}-prompts"


Policy = Committed | Rule | Training

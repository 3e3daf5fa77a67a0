"""What a recipe of reinforcement learning says."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import draccus
from draccus.utils import ParsingError
from lerobot.configs import PreTrainedConfig

from kitchen_prefs.utils.suggestions import suggest
from kitchen_prefs_experiments.recipes import recipe_file


@dataclass
class Settings:
    """What is trained, and the constants of PPO (Schulman et al., 2017).

    Attributes:
        policy: The policy that learns, such as `type: gnn`.
        environments: How many environments are played at once.
        steps: Decisions in each environment between two updates.
        batch_size: Decisions of one gradient step.
        epochs: How often an update goes through what was played.
        learning_rate: Adam's.
        weight_decay: Adam's.
        discount: Of rewards, gamma.
        gae_lambda: Of advantage estimates.
        clip_range: How far an update may move the probability of a choice.
        entropy: Weight of the entropy that keeps choices varied.
        save_freq: Interactions between two checkpoints.
        seed: Of weights, sessions and choices.
    """

    policy: PreTrainedConfig
    environments: int = 8
    steps: int = 250
    batch_size: int = 100
    epochs: int = 10
    learning_rate: float = 3e-4
    weight_decay: float = 0.0
    discount: float = 0.99
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    entropy: float = 0.0
    save_freq: int = 4_000
    seed: int = 1000

    def __post_init__(self) -> None:
        for name in ("environments", "steps", "batch_size", "epochs", "save_freq"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} is {getattr(self, name)}; it must be at least 1.")
        if self.rollout % self.batch_size:
            raise ValueError(
                f"batch_size divides environments times steps, which is {self.rollout}; "
                f"{self.batch_size} does not."
            )
        if self.save_freq % self.rollout:
            raise ValueError(
                f"save_freq is a multiple of environments times steps, which is {self.rollout}; "
                f"{self.save_freq} is not."
            )
        if getattr(self.policy, "failures", False):
            raise ValueError(
                "failures are invented where demonstrations are learned; leave policy.failures off."
            )

    @property
    def rollout(self) -> int:
        """How many decisions are played between two updates."""
        return self.environments * self.steps


def read_settings(recipe: str, options: Sequence[str]) -> Settings:
    """Read a recipe.

    Args:
        recipe: Its name.
        options: Settings to override, as in `--epochs=4` or `--policy.dim=64`.

    Raises:
        ValueError: If there is no such recipe, or if a setting is unknown or wrong.
    """
    known = [field.name for field in fields(Settings)]
    for option in options:
        name = option.removeprefix("--").partition("=")[0]
        if name.partition(".")[0] not in known:
            raise ValueError(f"PPO has no setting {name!r}. {suggest(name, known)}")
    try:
        return draccus.parse(Settings, recipe_file(recipe), args=list(options))
    except ParsingError as error:
        raise ValueError(
            f"The recipe {recipe!r} is none of reinforcement learning, or a setting is wrong: "
            f"{error.__cause__ or error}"
        ) from error

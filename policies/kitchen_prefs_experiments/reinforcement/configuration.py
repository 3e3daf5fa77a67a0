"""The configuration of PPO, under stable-baselines3's names."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import draccus
from draccus.utils import ParsingError
from lerobot.configs import PreTrainedConfig

from kitchen_prefs.utils.suggestions import check_settings
from kitchen_prefs_experiments.recipes import recipe_file


@dataclass
class Args:
    """The policy that learns, and the constants of PPO (Schulman et al., 2017).

    Attributes:
        policy: The policy that learns, such as `type: gnn`.
        num_envs: The number of environments that are stepped in turn.
        n_steps: The number of decisions in each environment between two updates.
        batch_size: The number of decisions in a gradient step.
        n_epochs: How often an update goes through the decisions since the last one.
        learning_rate: The learning rate of Adam.
        weight_decay: The weight decay of Adam.
        gamma: The discount factor of rewards.
        gae_lambda: The factor between bias and variance of generalised advantage estimates.
        clip_range: How far an update may move the probability ratio of a choice from 1.
        ent_coef: The weight of the entropy, which keeps choices varied, in the loss.
        save_freq: The number of interactions between two checkpoints.
        seed: The seed of weights, sessions and choices.
    """

    policy: PreTrainedConfig
    num_envs: int = 8
    n_steps: int = 250
    batch_size: int = 100
    n_epochs: int = 10
    learning_rate: float = 3e-4
    weight_decay: float = 0.0
    gamma: float = 0.99
    gae_lambda: float = 0.95
    clip_range: float = 0.2
    ent_coef: float = 0.0
    save_freq: int = 4_000
    seed: int = 1000

    def __post_init__(self) -> None:
        for name in ("num_envs", "n_steps", "batch_size", "n_epochs", "save_freq"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name} is {getattr(self, name)}; it must be at least 1.")
        if self.rollout_size % self.batch_size:
            raise ValueError(
                f"batch_size divides num_envs times n_steps, which is {self.rollout_size}; "
                f"{self.batch_size} does not."
            )
        if self.save_freq % self.rollout_size:
            raise ValueError(
                f"save_freq is a multiple of num_envs times n_steps, which is {self.rollout_size}; "
                f"{self.save_freq} is not."
            )
        if getattr(self.policy, "failures", False):
            raise ValueError(
                "Failed choices are synthesised from demonstrations alone; leave policy.failures "
                "off."
            )

    @property
    def rollout_size(self) -> int:
        """The number of decisions between two updates."""
        return self.num_envs * self.n_steps


def read_args(recipe: str, options: Sequence[str]) -> Args:
    """Read a recipe.

    Args:
        recipe: Its name.
        options: Settings to override, as in `--n_epochs=4` or `--policy.dim=64`.

    Raises:
        ValueError: If there is no such recipe, or if a setting is unknown or wrong.
    """
    check_settings("PPO", [field.name for field in fields(Args)], options)
    try:
        return draccus.parse(Args, recipe_file(recipe), args=list(options))
    except ParsingError as error:
        raise ValueError(
            f"The recipe {recipe!r} is not one of reinforcement learning, or a setting is wrong: "
            f"{error.__cause__ or error}"
        ) from error

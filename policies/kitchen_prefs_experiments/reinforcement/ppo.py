"""PPO around a LeRobot policy: its scores are the logits, and a value head is added.

observation - policy.score_rows - scores (B, N) - the distribution over rows
- summary (B, d) - linear - the value
"""

from typing import Any, Protocol

import torch
from gymnasium import spaces
from sb3_contrib import MaskablePPO
from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy
from stable_baselines3 import PPO
from stable_baselines3.common.policies import ActorCriticPolicy
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.type_aliases import Schedule
from stable_baselines3.common.vec_env import VecEnv
from torch import Tensor, nn

from kitchen_prefs.envs.lerobot_env import FEATURES_MAP
from kitchen_prefs.instances import CAPACITY
from kitchen_prefs_experiments.reinforcement.configuration import Args

# The arguments of stable-baselines3's PPO that `Args` holds under the same names.
PPO_CONSTANTS = (
    "learning_rate",
    "n_steps",
    "batch_size",
    "n_epochs",
    "gamma",
    "gae_lambda",
    "clip_range",
    "ent_coef",
)


class RowScores(Protocol):
    """A policy's output for B sets: a score for every row, (B, N), and a summary, (B, d)."""

    @property
    def scores(self) -> Tensor:
        """The scores, (B, N)."""

    @property
    def summary(self) -> Tensor:
        """The summaries, (B, d)."""


class RowScorer(Protocol):
    """A policy that can be trained from rewards."""

    @property
    def summary_size(self) -> int:
        """The size d of a summary."""

    def score_rows(self, batch: dict[str, Tensor], failed: Tensor) -> RowScores:
        """Score the rows of sets; `failed` marks failed choices, (B, N) bool."""


class RowScoresExtractor(BaseFeaturesExtractor):
    """The policy's scores and summaries, side by side, (B, N + d)."""

    def __init__(self, observation_space: spaces.Dict, policy: Any) -> None:
        """Wrap the policy, a `RowScorer`: the trained module is the one that is saved."""
        super().__init__(observation_space, CAPACITY + policy.summary_size)
        self.policy = policy

    def forward(self, observations: dict[str, Tensor]) -> Tensor:
        """Score the observations of B environments."""
        batch = {FEATURES_MAP[key]: value for key, value in observations.items()}
        none_failed = torch.zeros_like(
            observations["instances"][..., 0], dtype=torch.bool
        )  # (B, N)
        row_scores = self.policy.score_rows(batch, none_failed)
        return torch.cat([row_scores.scores, row_scores.summary], dim=1)


class SplitFeatures(nn.Module):
    """Splits the output of `RowScoresExtractor`; it replaces two networks of SB3."""

    def __init__(self, features_dim: int) -> None:
        """Set the sizes of the two parts."""
        super().__init__()
        self.latent_dim_pi = CAPACITY
        self.latent_dim_vf = features_dim - CAPACITY

    def forward(self, features: Tensor) -> tuple[Tensor, Tensor]:
        """Scores and summaries, (B, N) and (B, d)."""
        return self.forward_actor(features), self.forward_critic(features)

    def forward_actor(self, features: Tensor) -> Tensor:
        """The scores, (B, N)."""
        return features[:, :CAPACITY]

    def forward_critic(self, features: Tensor) -> Tensor:
        """The summaries, (B, d)."""
        return features[:, CAPACITY:]


class _ScoresAreLogits:
    """Changes to both of stable-baselines3's actor-critics: scores are the logits."""

    def _build_mlp_extractor(self: Any) -> None:
        self.mlp_extractor = SplitFeatures(self.features_dim)

    def _build(self: Any, lr_schedule: Schedule) -> None:
        super()._build(lr_schedule)  # type: ignore[misc]
        self.action_net = nn.Identity()
        self.optimizer = self.optimizer_class(
            self.parameters(), lr=lr_schedule(1), **self.optimizer_kwargs
        )


class RowPolicy(_ScoresAreLogits, ActorCriticPolicy):  # type: ignore[misc]
    """Chooses among all rows of the observation."""


class MaskedRowPolicy(_ScoresAreLogits, MaskableActorCriticPolicy):  # type: ignore[misc]
    """Chooses among the rows that the kitchen would carry out."""


def make_learner(
    args: Args, policy: RowScorer, environments: VecEnv, seed: int, masked: bool
) -> PPO | MaskablePPO:
    """Make PPO for a policy.

    Args:
        args: PPO's constants.
        policy: The policy that is trained.
        environments: Its environments.
        seed: The seed of the sessions and choices.
        masked: Whether infeasible decisions are masked.
    """
    constants: dict[str, Any] = {name: getattr(args, name) for name in PPO_CONSTANTS}
    constants |= {
        "seed": seed,
        "device": args.policy.device or "cpu",
        "policy_kwargs": {
            "features_extractor_class": RowScoresExtractor,
            "features_extractor_kwargs": {"policy": policy},
            "ortho_init": False,  # the same initial weights as in imitation
            # stable-baselines3's epsilon for PPO, and the recipe's weight decay
            "optimizer_kwargs": {"eps": 1e-5, "weight_decay": args.weight_decay},
        },
    }
    if masked:
        return MaskablePPO(MaskedRowPolicy, environments, **constants)
    return PPO(RowPolicy, environments, **constants)

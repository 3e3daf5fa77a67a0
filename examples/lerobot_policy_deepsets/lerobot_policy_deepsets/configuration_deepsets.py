"""The configuration of the DeepSets policy."""

from dataclasses import dataclass, field

from lerobot.configs import NormalizationMode, PreTrainedConfig
from lerobot.optim import AdamWConfig
from lerobot.optim.schedulers import CosineAnnealingWithWarmupSchedulerConfig

from lerobot_policy_kitchen_prefs.common.lerobot_features import check_sets_and_poses


@PreTrainedConfig.register_subclass("deepsets")
@dataclass
class DeepSetsConfig(PreTrainedConfig):
    """Sizes, and the training preset. Sets and poses are not normalised."""

    hidden: int = 96
    optimizer_lr: float = 1e-3
    normalization_mapping: dict[str, NormalizationMode] = field(default_factory=dict)
    observation_delta_indices = action_delta_indices = reward_delta_indices = None

    def get_optimizer_preset(self) -> AdamWConfig:
        """AdamW, with LeRobot's defaults."""
        return AdamWConfig(lr=self.optimizer_lr)

    def get_scheduler_preset(self) -> CosineAnnealingWithWarmupSchedulerConfig:
        """A cosine to zero, after a warm-up."""
        return CosineAnnealingWithWarmupSchedulerConfig(num_warmup_steps=100)

    def validate_features(self) -> None:
        """Check that there are sets and poses."""
        check_sets_and_poses(self)

"""Which attack."""

from dataclasses import dataclass, field
from typing import Any

from lerobot.configs import NormalizationMode, PreTrainedConfig


@PreTrainedConfig.register_subclass("attackers")
@dataclass
class AttackersConfig(PreTrainedConfig):
    """The attack: "peek", "neighbours" (of a batch) or "memory" (of earlier episodes)."""

    attack: str = "peek"
    normalization_mapping: dict[str, NormalizationMode] = field(default_factory=dict)

    observation_delta_indices = action_delta_indices = reward_delta_indices = None

    def get_optimizer_preset(self) -> Any: ...
    def get_scheduler_preset(self) -> Any: ...
    def validate_features(self) -> None: ...

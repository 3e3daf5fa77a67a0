"""What processor steps of training share: they read the data set that the policy is trained on."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Self

from lerobot.configs import PipelineFeatureType, PolicyFeature, PreTrainedConfig
from lerobot.datasets import LeRobotDatasetMetadata
from lerobot.processor import ProcessorStep
from lerobot.utils.constants import HF_LEROBOT_HOME

from kitchen_prefs.datasets.demonstration_store import DemonstrationStore

Features = dict[PipelineFeatureType, dict[str, PolicyFeature]]


@lru_cache(maxsize=2)
def read_demonstrations(repo_id: str, root: str | None) -> DemonstrationStore:
    """Read a data set's demonstrations once a process.

    Args:
        repo_id: The data set's name for LeRobot, such as `kitchen_prefs/dishwasher-train-v1`.
        root: Its folder; None is LeRobot's default.

    Returns:
        The demonstrations, all rows of them.
    """
    return DemonstrationStore.read(LeRobotDatasetMetadata(repo_id, root), chosen_only=False)


def location_of_dataset(config: PreTrainedConfig) -> dict[str, str | None]:
    """Where the data set lies that a policy is about to be trained on.

    LeRobot's `make_policy` notes the data set in the policy's configuration before it makes the
    processors (`lerobot.policies.factory`); `lerobot-train` passes it to them in no other way.

    Args:
        config: The policy's configuration.

    Returns:
        Its `repo_id`, and its `root` where that is not LeRobot's default; None where the policy is
        not about to be trained.
    """
    meta: LeRobotDatasetMetadata | None = getattr(config, "_runtime_dataset_meta", None)
    if meta is None:
        return {"repo_id": None, "root": None}
    is_default = meta.root == HF_LEROBOT_HOME / meta.repo_id
    return {"repo_id": meta.repo_id, "root": None if is_default else str(meta.root)}


@dataclass
class DatasetStep(ProcessorStep):
    """A step that reads a data set, and draws from it by a seed.

    Attributes:
        repo_id: The data set that the policy is trained on. Checkpoints store it, for `--resume`.
        root: Its folder, where that is not LeRobot's default.
        seed: The seed of what is drawn.
    """

    repo_id: str | None = None
    root: str | None = None
    seed: int = 0

    @classmethod
    def from_config(cls, config: PreTrainedConfig, seed: int = 0) -> Self:
        """Make the step in a policy's `make_TYPE_pre_post_processors`.

        Args:
            config: The policy's configuration.
            seed: The seed of what is drawn.

        Returns:
            The step, for the data set that the policy is about to be trained on.
        """
        return cls(**location_of_dataset(config), seed=seed)

    def get_config(self) -> dict[str, Any]:
        """What a checkpoint stores of the step."""
        return {"repo_id": self.repo_id, "root": self.root, "seed": self.seed}

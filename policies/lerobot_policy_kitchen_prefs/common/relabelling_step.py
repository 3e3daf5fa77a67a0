"""Relabelling as a processor step, for any LeRobot policy that learns from prompts."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Self

import numpy as np
import torch
from lerobot.configs import PipelineFeatureType, PolicyFeature, PreTrainedConfig
from lerobot.lerobot_types import EnvTransition, TransitionKey
from lerobot.processor import ProcessorStep, ProcessorStepRegistry

from kitchen_prefs.datasets.prompt_step import location_of_dataset, read_demonstrations
from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PROMPT
from kitchen_prefs.instances import COLUMNS, POSE, is_real

from .categories import Categories
from .instance_sets import chosen_rows
from .rack_poses import RackPoses
from .relabelling import relabel

STREAM = 1  # of randomness, independent of the one that `PromptStep` draws from

Features = dict[PipelineFeatureType, dict[str, PolicyFeature]]


@lru_cache(maxsize=2)
def read_categories(repo_id: str, root: str | None) -> tuple[Categories, RackPoses]:
    """Find the categories of a data set and their poses in the racks, once a process."""
    demonstrations = read_demonstrations(repo_id, root)
    categories = Categories.from_demonstrations(demonstrations)
    return categories, RackPoses.from_demonstrations(demonstrations, categories)


@ProcessorStepRegistry.register("kitchen_prefs_relabelling")
@dataclass
class RelabellingStep(ProcessorStep):
    """Permutes the categories of each sample, in its prompt, its set and its action together.

    It follows `PromptStep`. Observations of an environment, which have no frame index, pass
    unchanged.

    Attributes:
        repo_id: The data set that the policy is trained on.
        root: Its folder, where that is not LeRobot's default.
        seed: Another seed permutes the same batches otherwise.
    """

    repo_id: str | None = None
    root: str | None = None
    seed: int = 0

    @classmethod
    def from_config(cls, config: PreTrainedConfig, seed: int = 0) -> Self:
        """Make the step in a policy's `make_TYPE_pre_post_processors`.

        Args:
            config: The policy's configuration.
            seed: The seed of the permutations.

        Returns:
            The step, for the data set that the policy is about to be trained on.
        """
        return cls(**location_of_dataset(config), seed=seed)

    def __call__(self, transition: EnvTransition) -> EnvTransition:
        """Relabel a batch of B frames.

        Args:
            transition: The batch, with prompts and actions that are poses of rows.

        Returns:
            The batch, relabelled by a permutation for each sample.
        """
        frames = transition.get(TransitionKey.COMPLEMENTARY_DATA) or {}
        if self.repo_id is None or "index" not in frames:
            return transition
        observation = transition[TransitionKey.OBSERVATION]
        padded = observation[OBS_PROMPT]  # (B, P, 14)
        longest = int(is_real(padded).sum(dim=1).max())
        sets = observation[OBS_INSTANCES].reshape(len(padded), -1, COLUMNS)  # (B, N, 13)
        samples = torch.arange(len(sets), device=sets.device)  # (B,)
        targets = chosen_rows(sets, transition[TransitionKey.ACTION])  # (B,)
        generator = np.random.default_rng([STREAM, self.seed, *frames["index"].tolist()])
        prompts = torch.zeros_like(padded)
        prompts[:, :longest], sets = relabel(
            *(padded[:, :longest], sets, samples),
            *read_categories(self.repo_id, self.root),
            generator,
        )
        relabelled = {OBS_PROMPT: prompts, OBS_INSTANCES: sets.view_as(observation[OBS_INSTANCES])}
        return {
            **transition,
            TransitionKey.OBSERVATION: {**observation, **relabelled},
            TransitionKey.ACTION: sets[samples, targets][:, POSE],
        }

    def get_config(self) -> dict[str, Any]:
        """What a checkpoint stores of the step."""
        return {"repo_id": self.repo_id, "root": self.root, "seed": self.seed}

    def transform_features(self, features: Features) -> Features:
        """The features of a batch, which stay."""
        return features

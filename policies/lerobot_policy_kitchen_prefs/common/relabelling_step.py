"""Relabelling as a processor step, for any LeRobot policy that learns from prompts."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import torch
from lerobot.lerobot_types import EnvTransition, TransitionKey
from lerobot.processor import ProcessorStepRegistry

from kitchen_prefs.datasets.dataset_step import DatasetStep, Features, read_demonstrations
from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PROMPT
from kitchen_prefs.instances import COLUMNS, POSE, is_real

from .categories import Categories
from .instance_sets import chosen_rows
from .rack_poses import RackPoses
from .relabelling import relabel

STREAM = 1  # of randomness, independent of the one that `PromptStep` draws from


@lru_cache(maxsize=2)
def read_categories(repo_id: str, root: str | None) -> tuple[Categories, RackPoses]:
    """Find the categories of a data set and their poses in the racks, once a process."""
    demonstrations = read_demonstrations(repo_id, root)
    categories = Categories.from_demonstrations(demonstrations)
    return categories, RackPoses.from_demonstrations(demonstrations, categories)


@ProcessorStepRegistry.register("kitchen_prefs_relabelling")
@dataclass
class RelabellingStep(DatasetStep):
    """Permutes the categories of each sample, in its prompt, its set and its action together.

    It follows `PromptStep`. Observations of an environment, which have no frame index, pass
    unchanged.

    Attributes:
        seed: Another seed permutes the same batches otherwise.
    """

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

    def transform_features(self, features: Features) -> Features:
        """The features of a batch, which stay."""
        return features

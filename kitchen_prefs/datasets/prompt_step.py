"""Prompts in training, for any LeRobot policy: `observation.prompt` as the environment gives it.

The environment's observation contains a prompt, a demonstration of the user in another session. A
data set does not, as each frame would repeat a thousand rows. `PromptStep` adds it: put first into
a policy's preprocessor, it pairs each sample with another episode of the same preference.

    batch of lerobot-train                       batch that the policy receives
      observation.instances  (B, 936)              observation.instances  (B, 936)
      episode_index, index   (B,)      ------>     observation.prompt     (B, 1664, 14)
                                    PromptStep

In the second tier a prompt is (B, 2048, 22), and another session of the same user.

The standard track allows this use of the training split's `preference`: it pairs prompts with
samples, and no network reads it.
"""

from dataclasses import dataclass

import numpy as np
import torch
from lerobot.configs import FeatureType, PipelineFeatureType, PolicyFeature
from lerobot.lerobot_types import EnvTransition, TransitionKey
from lerobot.processor import ProcessorStepRegistry
from torch import Tensor

from kitchen_prefs.datasets.dataset_step import DatasetStep, Features, read_demonstrations
from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PROMPT
from kitchen_prefs.instances import COLUMNS, COLUMNS_OF_FLAT, POSE, PROMPT_CAPACITIES


@ProcessorStepRegistry.register("kitchen_prefs_prompt")
@dataclass
class PromptStep(DatasetStep):
    """Adds `observation.prompt`, (B, P, D + 1) float32, to batches of a data set.

    The prompts depend on the seed and on the frames of the batch alone, so a resumed training
    repeats an unbroken one. An observation that contains a prompt already, as the environment's
    does, passes unchanged.

    Attributes:
        seed: Another seed pairs the same batches with other prompts.
    """

    def __call__(self, transition: EnvTransition) -> EnvTransition:
        """Add prompts to a batch of B frames.

        Args:
            transition: The batch, with `index`, `episode_index` and `action` of a data set, or with
                a prompt.

        Returns:
            The batch with prompts.

        Raises:
            ValueError: If the batch has neither a prompt nor the columns of the step's data set, or
                if a preference has a single episode.
        """
        observation = transition.get(TransitionKey.OBSERVATION) or {}
        if OBS_PROMPT in observation:
            return transition
        frames = transition.get(TransitionKey.COMPLEMENTARY_DATA) or {}
        if self.repo_id is None or "index" not in frames or "episode_index" not in frames:
            raise ValueError(
                f"The batch contains no {OBS_PROMPT!r} and is none of a training data set; roll "
                "the policy out in an environment of kitchen_prefs, or train it by lerobot-train."
            )
        index, episodes = frames["index"].cpu().numpy(), frames["episode_index"].cpu().numpy()
        self._check(index, episodes, transition[TransitionKey.ACTION])
        prompts = self._prompts(index, episodes).to(frames["index"].device)
        return {**transition, TransitionKey.OBSERVATION: {**observation, OBS_PROMPT: prompts}}

    def transform_features(self, features: Features) -> Features:
        """The features of a batch, with the prompt's, which has the tier of the observed sets.

        Where no set is observed, it is the first tier's.
        """
        observed = features.get(PipelineFeatureType.OBSERVATION, {})
        width = observed[OBS_INSTANCES].shape[-1] if OBS_INSTANCES in observed else COLUMNS
        columns = COLUMNS_OF_FLAT.get(width, width)
        prompt = PolicyFeature(FeatureType.STATE, (PROMPT_CAPACITIES[columns], columns + 1))
        return {**features, PipelineFeatureType.OBSERVATION: {**observed, OBS_PROMPT: prompt}}

    def _check(self, index: np.ndarray, episodes: np.ndarray, action: Tensor) -> None:
        """Check that a batch is of the step's data set: frame i has the i-th chosen row's pose."""
        store = read_demonstrations(str(self.repo_id), self.root)
        poses = store.rows[store.rows[:, -1] > 0][:, POSE]  # (T, 7)
        known = index.max() < len(poses) and episodes.max() < len(store.preference)
        actions = action.cpu().numpy().reshape(len(index), -1, poses.shape[1])  # (B, K, 7)
        if not known or not (actions == poses[index][:, None]).all(-1).any(-1).all():
            raise ValueError(
                f"The batch is not of the data set {self.repo_id!r} that the step "
                "'kitchen_prefs_prompt' draws from: put the step first, before actions are "
                "normalised; a checkpoint that is trained further on another data set names it as "
                "the step's repo_id in its policy_preprocessor.json."
            )

    def _prompts(self, index: np.ndarray, episodes: np.ndarray) -> Tensor:
        """Draw another episode of the same preference for each frame, (B, P, D + 1)."""
        store = read_demonstrations(str(self.repo_id), self.root)
        generator = np.random.default_rng([self.seed, *index])
        drawn = [store.draw(store.preference[e], np.array([e]), generator) for e in episodes]
        alone = episodes[episodes == drawn]
        if len(alone):
            raise ValueError(
                f"Episode {alone[0]} of {self.repo_id!r} is the only one of its preference, so "
                "none can prompt it; train on two demonstrations of each preference or more."
            )
        capacity = PROMPT_CAPACITIES[store.rows.shape[1] - 1]
        return torch.from_numpy(store.prompts(drawn, capacity))

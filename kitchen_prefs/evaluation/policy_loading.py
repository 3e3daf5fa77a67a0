"""A LeRobot policy made ready to act: loaded, with its processors, known by a fingerprint."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from pathlib import Path
from typing import Any

import draccus
import numpy as np
import torch
from draccus.utils import ParsingError
from lerobot.configs import PreTrainedConfig
from lerobot.envs import env_to_policy_features, preprocess_observation
from lerobot.policies import PreTrainedPolicy, get_policy_class, make_pre_post_processors
from lerobot.processor import PolicyProcessorPipeline
from lerobot.utils.constants import ACTION
from lerobot.utils.import_utils import register_third_party_plugins

from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, KitchenPrefsEnv
from kitchen_prefs.evaluation.adapter_reading import read_adapter
from kitchen_prefs.evaluation.checkpoint_reading import (
    find_checkpoint,
    find_policy_below,
    read_config,
    read_policy,
    read_processors,
    setting_names,
)
from kitchen_prefs.evaluation.policy_fingerprint import Adapter, fingerprint
from kitchen_prefs.evaluation.policy_options import check_one_policy
from kitchen_prefs.utils.suggestions import check_settings, suggest

KNOWN_PACKAGES = ("lerobot", "lerobot_policy_kitchen_prefs")


@dataclass(frozen=True)
class LoadedPolicy:
    """A policy with its processors, as `lerobot-eval` runs it.

    Attributes:
        policy: The policy.
        preprocessor: Its pipeline from observations to inputs.
        postprocessor: Its pipeline from outputs to actions.
        track: The track whose observations it receives.
        adapter: What is merged into the policy.
    """

    policy: PreTrainedPolicy
    preprocessor: PolicyProcessorPipeline
    postprocessor: PolicyProcessorPipeline
    track: str
    adapter: Adapter | None = None

    def reset(self) -> None:
        """Clear the policy's state: a new batch of episodes begins."""
        self.policy.reset()

    def act(self, observations: Sequence[dict[str, np.ndarray]], tasks: list[str]) -> np.ndarray:
        """Choose actions for B episodes at once.

        Args:
            observations: The observation of each environment.
            tasks: The task description of each environment.

        Returns:
            The actions, (B, 7) float32.
        """
        names = observations[0].keys()
        stacked = {name: np.stack([one[name] for one in observations]) for name in names}
        batch: dict[str, Any] = preprocess_observation(stacked)
        batch[OBS_INSTANCES] = self._as_trained(batch[OBS_INSTANCES])
        batch["task"] = tasks
        with torch.inference_mode():
            action = self.policy.select_action(self.preprocessor(batch))  # (B, 7)
        return self.postprocessor(action).to("cpu", torch.float32).numpy()

    def _as_trained(self, sets: torch.Tensor) -> torch.Tensor:
        """The sets, (B, N, D), flat, as data sets have them since their second format."""
        feature = (self.policy.config.input_features or {}).get(OBS_INSTANCES)
        rows = feature is not None and len(feature.shape) == 2
        return sets if rows else sets.flatten(1)

    @property
    def type(self) -> str:
        """The policy's type."""
        return self.policy.config.type

    @property
    def plugin(self) -> str | None:
        """The package that it comes from; None if that is LeRobot or this benchmark's."""
        package = type(self.policy.config).__module__.partition(".")[0]
        return None if package in KNOWN_PACKAGES else package

    @property
    def parameters(self) -> int:
        """The number of its weights."""
        return sum(weight.numel() for weight in self.policy.parameters())

    @property
    def fingerprint(self) -> str:
        """A hash of all weights and settings that change its behaviour, the processors' too."""
        return fingerprint(self.policy, (self.preprocessor, self.postprocessor), self.adapter)


def load_policy(
    path: str | None = None,
    policy_type: str | None = None,
    options: Sequence[str] = (),
    *,
    track: str | None = None,
    below: str | None = None,
    split: str = "seen",
) -> LoadedPolicy:
    """Load a checkpoint, or make a policy that needs no training.

    Args:
        path: A checkpoint's folder `pretrained_model`, or its name on the Hugging Face hub.
        policy_type: The type of a policy that needs no training, such as "rules".
        options: Settings of the policy to override, as in `--rule=expert`.
        track: The track of the environment; if not given, the track that the policy's settings
            ask for, or else the standard one.
        below: The folder of the policy that an adapter was trained on; if not given, the one that
            the adapter names.
        split: The split whose observations it has to fit.

    Returns:
        The policy, ready to act.

    Raises:
        ValueError: If not exactly one of `path` and `policy_type` is given, or if the policy is
            unknown, damaged or not trained, has no such setting, or does not fit the environment.
    """
    register_third_party_plugins()
    check_one_policy(path, policy_type)
    try:
        if path:
            folder = find_checkpoint(path)
            found = Path(below) if below else find_policy_below(folder)
            return _trained(folder, options, track, found, split)
        return _untrained(str(policy_type), options, track, split)
    except ParsingError as error:
        raise ValueError(f"The policy's settings are wrong: {error.__cause__ or error}") from error


def _trained(
    folder: Path, options: Sequence[str], track: str | None, below: Path | None, split: str
) -> LoadedPolicy:
    config = read_config(folder, options)
    environment = _environment(config, track, split)
    _check_features(config, environment)
    preprocessor, postprocessor = read_processors(folder, config)
    policy = read_policy(folder, config, options, below)
    adapter = None
    if below:
        adapted = _trained(below, (), track, None, split)
        adapter = Adapter(*read_adapter(folder), adapted.fingerprint)
    return LoadedPolicy(policy, preprocessor, postprocessor, environment.track, adapter)


def _untrained(
    policy_type: str, options: Sequence[str], track: str | None, split: str
) -> LoadedPolicy:
    """Make a policy without weights; LeRobot's factory would warn that it lacks statistics."""
    known = PreTrainedConfig.get_known_choices()
    if policy_type not in known:
        raise ValueError(f"There is no policy type {policy_type!r}. {suggest(policy_type, known)}")
    check_settings("The policy", setting_names(known[policy_type]), options)
    config = draccus.parse(known[policy_type], args=list(options))
    environment = _environment(config, track, split)
    features = env_to_policy_features(environment)
    config.output_features = {ACTION: features.pop(ACTION)}
    config.input_features = features
    policy = get_policy_class(policy_type)(config)
    if next(policy.parameters(), None) is not None:
        raise ValueError(f"{policy_type!r} has to be trained first: give --policy.path=CHECKPOINT.")
    policy.eval()
    preprocessor, postprocessor = make_pre_post_processors(config)
    return LoadedPolicy(policy, preprocessor, postprocessor, environment.track)


def _environment(config: PreTrainedConfig, track: str | None, split: str) -> KitchenPrefsEnv:
    asked_for: str = getattr(config, "track", "standard")
    # With sets as rows, so that policies without a checkpoint keep the fingerprints they have had.
    return KitchenPrefsEnv(task=split, track=track or asked_for, flat=False)


def _check_features(config: PreTrainedConfig, environment: KitchenPrefsEnv) -> None:
    """Check that the observation contains the features that a checkpoint was trained on."""
    observed = env_to_policy_features(environment)
    trained_on = {**(config.input_features or {}), **(config.output_features or {})}
    for name, feature in trained_on.items():
        if name not in observed:
            raise ValueError(
                f"The policy was trained on {name!r}, which the environment does not show on the "
                f"{environment.track} track."
            )
        # A set is flat, or has rows in checkpoints of the data's first format.
        same_set = name == OBS_INSTANCES and prod(feature.shape) == prod(observed[name].shape)
        if not same_set and tuple(feature.shape) != tuple(observed[name].shape):
            raise ValueError(
                f"The policy was trained on {name!r} of shape {tuple(feature.shape)}; the "
                f"environment's has {tuple(observed[name].shape)}. Train it on this data version."
            )

"""A LeRobot policy made ready to act: loaded, with its processors, known by a fingerprint."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import draccus
import numpy as np
import torch
from draccus.utils import ParsingError
from huggingface_hub.errors import HFValidationError
from lerobot.configs import PreTrainedConfig
from lerobot.envs import env_to_policy_features, preprocess_observation
from lerobot.policies import (
    PreTrainedPolicy,
    get_policy_class,
    make_policy,
    make_pre_post_processors,
)
from lerobot.processor import PolicyProcessorPipeline
from lerobot.utils.constants import ACTION
from lerobot.utils.import_utils import register_third_party_plugins

from kitchen_prefs.environment_config import KitchenPrefsEnv
from kitchen_prefs.splits import suggest

# Where a policy runs and where it is kept say nothing about what it does.
NOT_BEHAVIOUR = (
    "device",
    "license",
    "pretrained_path",
    "pretrained_revision",
    "private",
    "push_to_hub",
    "repo_id",
    "tags",
)


@dataclass(frozen=True)
class Actor:
    """A policy with its processors, as `lerobot-eval` runs it.

    Attributes:
        policy: The policy.
        preprocessor: Its pipeline from observations to inputs.
        postprocessor: Its pipeline from outputs to actions.
        track: What the environment tells it.
    """

    policy: PreTrainedPolicy
    preprocessor: PolicyProcessorPipeline
    postprocessor: PolicyProcessorPipeline
    track: str

    def reset(self) -> None:
        """Forget everything: a new batch of episodes begins."""
        self.policy.reset()

    def act(self, observations: Sequence[dict[str, np.ndarray]], tasks: list[str]) -> np.ndarray:
        """Decide for B episodes at once.

        Args:
            observations: What each environment shows.
            tasks: What each environment says to do.

        Returns:
            The actions, (B, 7) float32.
        """
        names = observations[0].keys()
        stacked = {name: np.stack([seen[name] for seen in observations]) for name in names}
        batch: dict[str, Any] = preprocess_observation(stacked)
        batch["task"] = tasks
        with torch.inference_mode():
            action = self.policy.select_action(self.preprocessor(batch))  # (B, 7)
        return self.postprocessor(action).to("cpu", torch.float32).numpy()

    @property
    def fingerprint(self) -> str:
        """A hash of the weights and of the settings that change what the policy does."""
        settings = draccus.encode(self.policy.config, PreTrainedConfig)
        settings = {name: settings[name] for name in settings if name not in NOT_BEHAVIOUR}
        sha = hashlib.sha256(json.dumps(settings, sort_keys=True).encode())
        for name, weight in sorted(self.policy.state_dict().items()):
            sha.update(name.encode())
            sha.update(weight.detach().cpu().reshape(-1).view(torch.uint8).numpy().tobytes())
        return sha.hexdigest()


def load_actor(
    path: str | None = None,
    policy_type: str | None = None,
    options: Sequence[str] = (),
    *,
    track: str | None = None,
) -> Actor:
    """Load a checkpoint, or make a policy that needs no training.

    Args:
        path: A checkpoint's folder `pretrained_model`, or its name on the Hugging Face hub.
        policy_type: The type of a policy that needs no training, such as "rules".
        options: Settings of the policy to override, as in `--rule=expert`.
        track: What the environment tells the policy; if not given, the track that the policy's
            settings ask for, or else the standard one.

    Returns:
        The policy, ready to act.

    Raises:
        ValueError: If not just one of `path` and `policy_type` is given, or if the policy is
            unknown, has no such setting, or does not fit the environment.
    """
    register_third_party_plugins()
    if (path is None) == (policy_type is None):
        raise ValueError("Give either --policy.path=CHECKPOINT or --policy.type=TYPE.")
    try:
        config = _read_config(path, options) if path else _make_config(str(policy_type), options)
    except ParsingError as error:
        raise ValueError(f"The policy's settings are wrong: {error.__cause__ or error}") from error
    asked_for: str = getattr(config, "track", "standard")
    environment = KitchenPrefsEnv(track=track or asked_for)
    _check_features(config, environment)
    policy = _trained(config, environment) if path else _untrained(config, environment)
    policy.eval()
    overrides = {"device_processor": {"device": config.device}} if path else {}
    pre, post = make_pre_post_processors(config, path, preprocessor_overrides=overrides)
    return Actor(policy, pre, post, environment.track)


def _read_config(path: str, options: Sequence[str]) -> PreTrainedConfig:
    nowhere = (
        f"There is no policy in {path}; give a folder such as RUN/checkpoints/last/pretrained_model"
    )
    if Path(path).is_dir() and not (Path(path) / "config.json").exists():
        raise ValueError(f"{nowhere}.")
    try:
        config = PreTrainedConfig.from_pretrained(path)
        _check_settings(type(config), options)
        config = PreTrainedConfig.from_pretrained(path, cli_overrides=list(options))
    except (OSError, HFValidationError) as error:
        raise ValueError(f"{nowhere}, or a policy's name on the hub.") from error
    config.pretrained_path = Path(path)
    return config


def _make_config(policy_type: str, options: Sequence[str]) -> PreTrainedConfig:
    known = PreTrainedConfig.get_known_choices()
    if policy_type not in known:
        raise ValueError(f"There is no policy type {policy_type!r}. {suggest(policy_type, known)}")
    _check_settings(known[policy_type], options)
    return draccus.parse(known[policy_type], args=list(options))


def _trained(config: PreTrainedConfig, environment: KitchenPrefsEnv) -> PreTrainedPolicy:
    try:
        return make_policy(config, env_cfg=environment)
    except RuntimeError as error:  # torch's, for weights of other names or shapes
        raise ValueError(
            f"The weights in {config.pretrained_path} do not fit the config.json beside them; the "
            "checkpoint is damaged or was made by another version of the policy."
        ) from error


def _untrained(config: PreTrainedConfig, environment: KitchenPrefsEnv) -> PreTrainedPolicy:
    """Make a policy without weights; LeRobot's factory would warn that it lacks statistics."""
    features = env_to_policy_features(environment)
    config.output_features = {ACTION: features.pop(ACTION)}
    config.input_features = features
    return get_policy_class(config.type)(config)


def _check_settings(config_class: type[PreTrainedConfig], options: Sequence[str]) -> None:
    known = {field.name for field in fields(config_class)}
    for option in options:
        name = option.removeprefix("--").partition("=")[0]
        if name.partition(".")[0] not in known:
            raise ValueError(f"The policy has no setting {name!r}. {suggest(name, known)}")


def _check_features(config: PreTrainedConfig, environment: KitchenPrefsEnv) -> None:
    """Compare what a checkpoint was trained on with what the environment shows."""
    shown = env_to_policy_features(environment)
    trained_on = {**(config.input_features or {}), **(config.output_features or {})}
    for name, feature in trained_on.items():
        if name not in shown:
            raise ValueError(
                f"The policy was trained on {name!r}, which the environment does not show on the "
                f"{environment.track} track."
            )
        if tuple(feature.shape) != tuple(shown[name].shape):
            raise ValueError(
                f"The policy was trained on {name!r} of shape {tuple(feature.shape)}; the "
                f"environment's has {tuple(shown[name].shape)}. Train it on this data version."
            )

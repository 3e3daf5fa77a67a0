"""The fingerprint of a policy: a hash of all that decides what it does."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import draccus
import torch
from lerobot.configs import PreTrainedConfig
from lerobot.policies import PreTrainedPolicy
from lerobot.processor import PolicyProcessorPipeline

# Settings that do not change what a policy does: where it runs, where it is stored, and what would
# train it further.
NOT_BEHAVIOUR = (
    "device",
    "license",
    "optimizer",
    "pretrained_path",
    "pretrained_revision",
    "private",
    "push_to_hub",
    "repo_id",
    "scheduler",
    "tags",
)


@dataclass(frozen=True)
class Adapter:
    """What an adapter, such as LoRA, adds to a policy.

    Attributes:
        settings: Its method.
        weights: Its own weights.
        below: The fingerprint of the policy that it was trained on.
    """

    settings: Mapping[str, Any]
    weights: Mapping[str, torch.Tensor]
    below: str


def fingerprint(
    policy: PreTrainedPolicy, pipelines: Iterable[PolicyProcessorPipeline], adapter: Adapter | None
) -> str:
    """A hash of all weights and settings that change a policy's behaviour, its processors' too.

    Args:
        policy: The policy.
        pipelines: Its processors.
        adapter: What is merged into it. Merged weights depend on how a processor rounds, so the
            adapter is hashed and the policy below it.
    """
    sha = hashlib.sha256()
    settings = draccus.encode(policy.config, PreTrainedConfig)
    if adapter is None:
        _add(sha, settings, policy.state_dict())
    else:
        about = {"adapter": adapter.settings, "below": adapter.below}
        _add(sha, settings | about, adapter.weights)
    for pipeline in pipelines:
        for step in pipeline.steps:
            _add(sha, {"step": type(step).__name__, **step.get_config()}, step.state_dict())
    return sha.hexdigest()


def _add(
    sha: "hashlib._Hash", settings: dict[str, Any], weights: Mapping[str, torch.Tensor]
) -> None:
    kept = {name: value for name, value in settings.items() if name not in NOT_BEHAVIOUR}
    sha.update(json.dumps(kept, sort_keys=True).encode())
    for name, weight in sorted(weights.items()):
        sha.update(name.encode())
        sha.update(weight.detach().cpu().reshape(-1).view(torch.uint8).numpy().tobytes())

"""Reads an adapter, such as LoRA, and merges it into the policy that it was trained on.

pretrained_model/
    adapter_config.json         the method, and the path of the policy
    adapter_model.safetensors   the adapter's weights

`lerobot-train --peft.method_type=LORA` writes these two instead of `model.safetensors`.
"""

import json
from pathlib import Path
from typing import Any

import torch
from lerobot.configs import PreTrainedConfig
from lerobot.policies import PreTrainedPolicy, get_policy_class
from lerobot.utils.import_utils import is_package_available
from safetensors import SafetensorError
from safetensors.torch import load_file

BELOW = "base_model_name_or_path"  # the setting that names the policy
ADAPTER_CONFIG = "adapter_config.json"
ADAPTER_WEIGHTS = "adapter_model.safetensors"


def is_adapter(folder: Path) -> bool:
    """Whether a checkpoint holds an adapter instead of a policy's own weights."""
    return (folder / ADAPTER_CONFIG).is_file()


def policy_below(folder: Path) -> str:
    """The path, or the name on the hub, of the policy that an adapter was trained on.

    Raises:
        ValueError: If the adapter's configuration is damaged or names no policy.
    """
    path = _read_settings(folder).get(BELOW)
    if not isinstance(path, str) or not path:
        raise ValueError(
            f"{folder / ADAPTER_CONFIG} does not name the policy that the adapter was trained on."
        )
    return path


def read_adapter(folder: Path) -> tuple[dict[str, Any], dict[str, torch.Tensor]]:
    """An adapter's settings, without where its policy lies, and its own weights.

    Raises:
        ValueError: If one of the files is damaged.
    """
    settings = _read_settings(folder)
    settings.pop(BELOW, None)
    try:
        return settings, load_file(folder / ADAPTER_WEIGHTS)
    except (SafetensorError, OSError) as error:
        raise _damaged(folder / ADAPTER_WEIGHTS) from error


def _read_settings(folder: Path) -> dict[str, Any]:
    file = folder / ADAPTER_CONFIG
    try:
        return dict(json.loads(file.read_text()))
    except (OSError, ValueError, TypeError) as error:
        raise _damaged(file) from error


def _damaged(file: Path) -> ValueError:
    return ValueError(f"{file} is damaged; give another checkpoint.")


def read_adapted_policy(folder: Path, below: Path, config: PreTrainedConfig) -> PreTrainedPolicy:
    """Load a policy with an adapter merged into its weights.

    Args:
        folder: The adapter's checkpoint.
        below: The checkpoint that it was trained on.
        config: The settings of the adapter's checkpoint.

    Raises:
        ValueError: If PEFT is not installed, or if the adapter is damaged or does not fit.
    """
    if not is_package_available("peft"):
        raise ValueError(
            f"{folder} is an adapter, which needs PEFT; install it: pip install 'lerobot[peft]'."
        )
    from peft import PeftModel

    policy = get_policy_class(config.type).from_pretrained(below, config=config, strict=True)
    try:
        adapted = PeftModel.from_pretrained(policy, str(folder))
    except (SafetensorError, RuntimeError, ValueError, TypeError, KeyError) as error:
        raise ValueError(
            f"The adapter in {folder} is damaged or does not fit the policy in {below}."
        ) from error
    return adapted.merge_and_unload()

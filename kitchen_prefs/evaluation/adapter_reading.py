"""Reads an adapter, such as LoRA, and merges it into the policy that it was trained on.

pretrained_model/
    adapter_config.json         the method, and the path of the policy
    adapter_model.safetensors   the adapter's weights

`lerobot-train --peft.method_type=LORA` writes these two instead of `model.safetensors`.
"""

import json
from pathlib import Path

from lerobot.configs import PreTrainedConfig
from lerobot.policies import PreTrainedPolicy, get_policy_class
from lerobot.utils.import_utils import is_package_available
from safetensors import SafetensorError

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
    file = folder / ADAPTER_CONFIG
    try:
        path = json.loads(file.read_text())["base_model_name_or_path"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{file} is damaged; give another checkpoint.") from error
    if not isinstance(path, str) or not path:
        raise ValueError(f"{file} does not name the policy that the adapter was trained on.")
    return path


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

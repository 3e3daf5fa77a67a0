"""TTP for a page: its weights in half precision, and the script that runs them."""

import base64
from importlib.resources import files
from pathlib import Path
from typing import Any

from lerobot.policies.pretrained import PreTrainedPolicy
from lerobot.utils.import_utils import register_third_party_plugins
from safetensors.torch import save

from kitchen_prefs.evaluation.checkpoint_reading import (
    find_checkpoint,
    find_policy_below,
    read_config,
    read_policy,
)
from kitchen_prefs.web.page import joined

TEMPLATES = files("kitchen_prefs_demonstrations.page") / "templates"
# In the order in which a reader follows a decision from the observation to the choice.
MODULES = (
    "observation",
    "safetensors",
    "tensors",
    "instance_encoder",
    "transformer",
    "collision_model",
    "denoising",
    "failed_choices",
    "ttp",
)
# A page runs the compact TTP, with the settings that all recipes of it share; its sizes may differ.
REQUIRED = {
    "prompt_tokens": "chosen",
    "use_slots": False,
    "context_history": 0,
    "hidden": [],
    "pose_encoding": "fourier",
    "extents_encoding": "fourier",
    "time_encoding": "fourier",
    "situation_time": False,
    "pre_norm": True,
    "pointer": "outputs",
    "geometric_attention": True,
    "clashes": True,
    "failures": True,
}


def policy_script() -> str:
    """The script that observes and decides; it defines `observe` and `TTP` and no other name.

    It needs basics.js and kitchen.js before it, and `data.observed` of `observed_kitchen`.
    """
    modules = joined(*(TEMPLATES / f"{name}.js" for name in MODULES))
    return f"const {{ observe, TTP }} = (() => {{\n{modules}\nreturn {{ observe, TTP }};\n}})();\n"


def policy_data(checkpoint: Path | str) -> dict[str, Any]:
    """A checkpoint as the class `TTP` of the script takes it.

    Args:
        checkpoint: Its folder, or its name on the Hugging Face hub.

    Raises:
        ValueError: If there is no such checkpoint, if it is damaged, or if the page cannot run it.
    """
    register_third_party_plugins()
    folder = find_checkpoint(str(checkpoint))
    if find_policy_below(folder):
        raise ValueError(f"{folder} is an adapter, and a page runs whole policies; give another.")
    config = read_config(folder, ())
    _check_runnable(folder, config)
    policy = read_policy(folder, config)
    return {
        "heads": config.n_heads,
        "encoderLayers": config.n_encoder_layers,
        "decoderLayers": config.n_decoder_layers,
        "dimTime": config.dim_time,
        "weights": base64.b64encode(_half_precision(policy)).decode(),
    }


def _half_precision(policy: PreTrainedPolicy) -> bytes:
    """A policy's safetensors with its weights in half precision, half the size.

    What is no weight, such as the poses that noisy observations snap to, stays as it is.
    """
    weights = {name for name, _ in policy.named_parameters()}
    return save(
        {
            name: values.half() if name in weights else values
            for name, values in policy.state_dict().items()
        }
    )


def _check_runnable(folder: Path, config: Any) -> None:
    if config.type != "ttp":
        raise ValueError(
            f"The policy in {folder} is of the type {config.type!r}, and a page runs 'ttp' alone; "
            "give a checkpoint such as ttp_plus."
        )
    for name, value in REQUIRED.items():
        if getattr(config, name) != value:
            raise ValueError(
                f"The policy in {folder} has {name} {getattr(config, name)!r}, and a page runs TTP "
                f"with {value!r} alone; give a checkpoint such as ttp_plus."
            )

"""Reads a LeRobot checkpoint; a damaged file is named in one sentence.

pretrained_model/
    config.json               the policy's type and settings
    model.safetensors         its weights
    policy_preprocessor.json  its pipelines, with their statistics in .safetensors files
    policy_postprocessor.json

`lerobot-train` writes such a folder for each checkpoint; for an adapter, see `adapter_reading`.
"""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Any

from draccus.utils import ParsingError
from huggingface_hub import snapshot_download
from huggingface_hub.errors import HFValidationError
from lerobot.configs import PreTrainedConfig
from lerobot.policies import PreTrainedPolicy, get_policy_class, make_pre_post_processors
from lerobot.processor import PolicyProcessorPipeline, ProcessorStepRegistry
from lerobot.processor.pipeline import ProcessorMigrationError
from safetensors import SafetensorError

from kitchen_prefs.evaluation.adapter_reading import (
    ADAPTER_CONFIG,
    ADAPTER_WEIGHTS,
    is_adapter,
    policy_below,
    read_adapted_policy,
)
from kitchen_prefs.utils.suggestions import check_settings, suggest

CONFIG = "config.json"
WEIGHTS = "model.safetensors"
PROCESSORS = ("policy_preprocessor.json", "policy_postprocessor.json")
DEVICE_STEP = "device_processor"  # moves observations to where the policy runs
ADVICE = "give another checkpoint, or save it again with this version of the policy."

# What json, draccus, safetensors and LeRobot raise for damaged files. AttributeError, KeyError and
# TypeError are not among them: they would hide mistakes in the program.
READING_ERRORS = (
    ParsingError,
    ProcessorMigrationError,
    SafetensorError,
    ImportError,
    OSError,
    ValueError,
)


def find_checkpoint(path: str) -> Path:
    """Find a checkpoint's folder; it is downloaded if `path` names one on the Hugging Face hub.

    Raises:
        ValueError: If there is no checkpoint, or if it lacks a file.
    """
    nowhere = (
        f"There is no policy in {path}; give a folder such as RUN/checkpoints/last/pretrained_model"
    )
    folder = Path(path)
    if not folder.is_dir():
        try:
            folder = Path(snapshot_download(path, allow_patterns=["*.json", "*.safetensors"]))
        except (OSError, HFValidationError) as error:
            raise ValueError(f"{nowhere}, or a policy's name on the hub.") from error
    if not (folder / CONFIG).is_file():
        raise ValueError(f"{nowhere}.")
    for name in (_weights_of(folder), *PROCESSORS):
        if not (folder / name).is_file():
            raise ValueError(f"The checkpoint {folder} lacks {name}; {ADVICE}")
    return folder


def find_policy_below(folder: Path) -> Path | None:
    """Find the checkpoint that an adapter was trained on, on the disk or on the hub.

    Args:
        folder: A checkpoint.

    Returns:
        Its folder; None if the checkpoint is no adapter.

    Raises:
        ValueError: If it is not where the adapter says, or is an adapter itself.
    """
    if not is_adapter(folder):
        return None
    named = policy_below(folder)
    try:
        below = find_checkpoint(named)
    except ValueError as error:
        raise ValueError(
            f"The adapter in {folder} was trained on {named}, which is not here; write that "
            f"policy's folder, or its name on the hub, into {folder / ADAPTER_CONFIG}."
        ) from error
    if is_adapter(below):
        raise ValueError(f"{below} is an adapter itself; train {folder} on a policy.")
    return below


def read_config(folder: Path, options: Sequence[str]) -> PreTrainedConfig:
    """Read the settings of a checkpoint's policy, with some of them overridden.

    Raises:
        ValueError: If the file is damaged, or the policy is of an unknown type or has no such
            setting.
    """
    file = folder / CONFIG
    policy_type = _read_json(file).get("type")
    if not isinstance(policy_type, str):
        raise _damaged(file)
    known = PreTrainedConfig.get_known_choices()
    if policy_type not in known:
        raise ValueError(
            f"{file} is of the unknown policy type {policy_type!r}. {suggest(policy_type, known)}"
        )
    check_settings("The policy", setting_names(known[policy_type]), options)
    with _damage_reported(file):
        PreTrainedConfig.from_pretrained(folder)
    config = PreTrainedConfig.from_pretrained(folder, cli_overrides=list(options))
    config.pretrained_path = folder
    return config


def setting_names(config_class: type[PreTrainedConfig]) -> list[str]:
    """The names of a policy's settings."""
    return [field.name for field in fields(config_class)]


def read_policy(
    folder: Path,
    config: PreTrainedConfig,
    options: Sequence[str] = (),
    below: Path | None = None,
) -> PreTrainedPolicy:
    """Load the policy of a checkpoint; unlike in LeRobot's factory, no weight may be missing.

    Args:
        folder: The checkpoint.
        config: Its settings.
        options: Those of them that were overridden.
        below: The checkpoint that it was trained on, if it is an adapter.

    Raises:
        ValueError: If the weights are damaged or do not fit the policy.
    """
    try:
        if below:
            return read_adapted_policy(folder, below, config)
        return get_policy_class(config.type).from_pretrained(folder, config=config, strict=True)
    except SafetensorError as error:
        raise ValueError(f"{folder / _weights_of(folder)} is damaged; {ADVICE}") from error
    except RuntimeError as error:  # torch's, for weights of other names or shapes
        if options:
            raise ValueError(
                f"The weights in {folder} do not fit with {' '.join(options)}; leave out what "
                "changes the size of the policy."
            ) from error
        raise ValueError(
            f"The weights in {folder} do not fit the config.json beside them; {ADVICE}"
        ) from error


def _weights_of(folder: Path) -> str:
    return ADAPTER_WEIGHTS if is_adapter(folder) else WEIGHTS


def read_processors(
    folder: Path, config: PreTrainedConfig
) -> tuple[PolicyProcessorPipeline, PolicyProcessorPipeline]:
    """Load the pipelines that process the policy's inputs and its outputs.

    Raises:
        ValueError: If one of their files is damaged, or has a step that is not LeRobot's or a
            plug-in's.
    """
    preprocessor, postprocessor = (folder / name for name in PROCESSORS)
    if DEVICE_STEP not in _registered_steps(preprocessor):
        raise _damaged(preprocessor)
    _registered_steps(postprocessor)
    overrides = {DEVICE_STEP: {"device": config.device}}
    with _damage_reported(f"A processor in {folder}"):
        return make_pre_post_processors(config, str(folder), preprocessor_overrides=overrides)


def _registered_steps(file: Path) -> list[str]:
    """The names of a processor's steps; unregistered ones are refused, as LeRobot would run them.

    Raises:
        ValueError: If the file is damaged, or a step is not registered.
    """
    steps = _read_json(file).get("steps")
    if not isinstance(steps, list) or not all(isinstance(step, dict) for step in steps):
        raise _damaged(file)
    names = [step.get("registry_name") for step in steps]
    if not all(name in ProcessorStepRegistry.list() for name in names):
        raise ValueError(f"{file} has a step that is not registered, so it is not run.")
    if not all(isinstance(step.get("state_file", ""), str) for step in steps):
        raise _damaged(file)
    return names


def _read_json(file: Path) -> dict[str, Any]:
    with _damage_reported(file):
        content = json.loads(file.read_text())
    if not isinstance(content, dict):
        raise _damaged(file)
    return content


@contextmanager
def _damage_reported(what: Path | str) -> Iterator[None]:
    """Turns what a file's reader raises into one sentence about the file."""
    try:
        yield
    except READING_ERRORS as error:
        raise _damaged(what) from error


def _damaged(what: Path | str) -> ValueError:
    return ValueError(f"{what} is damaged; {ADVICE}")

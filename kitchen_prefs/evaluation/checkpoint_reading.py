"""A LeRobot checkpoint, read so that what is wrong with its files is said in one sentence.

pretrained_model/
    config.json               the policy's type and settings
    model.safetensors         its weights
    policy_preprocessor.json  its pipelines, with their statistics in .safetensors files
    policy_postprocessor.json

`lerobot-train` writes such a folder for each checkpoint.
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

from kitchen_prefs.utils.suggestions import suggest

CONFIG = "config.json"
WEIGHTS = "model.safetensors"
PROCESSORS = ("policy_preprocessor.json", "policy_postprocessor.json")
WAY_OUT = "give another checkpoint, or save it again with this version of the policy."

# What draccus, json, safetensors and LeRobot raise for files that are not what they should be.
READING_ERRORS = (
    ParsingError,
    ProcessorMigrationError,
    SafetensorError,
    AttributeError,
    ImportError,
    KeyError,
    OSError,
    TypeError,
    ValueError,
)


def find_checkpoint(path: str) -> Path:
    """The folder of a checkpoint, which is fetched if `path` is a name on the Hugging Face hub.

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
    for name in (WEIGHTS, *PROCESSORS):
        if not (folder / name).is_file():
            raise ValueError(f"The checkpoint {folder} lacks {name}; {WAY_OUT}")
    return folder


def read_config(folder: Path, options: Sequence[str]) -> PreTrainedConfig:
    """The settings of a checkpoint's policy, with some of them overridden.

    Raises:
        ValueError: If the file is damaged, or the policy is of an unknown type or has no such
            setting.
    """
    file = folder / CONFIG
    with _damage_reported(file):
        policy_type = str(_read_json(file)["type"])
    known = PreTrainedConfig.get_known_choices()
    if policy_type not in known:
        raise ValueError(
            f"{file} is of the unknown policy type {policy_type!r}. {suggest(policy_type, known)}"
        )
    check_settings(known[policy_type], options)
    with _damage_reported(file):
        PreTrainedConfig.from_pretrained(folder)
    config = PreTrainedConfig.from_pretrained(folder, cli_overrides=list(options))
    config.pretrained_path = folder
    return config


def check_settings(config_class: type[PreTrainedConfig], options: Sequence[str]) -> None:
    """Raise a ValueError if an option names a setting that the policy does not have."""
    known = [field.name for field in fields(config_class)]
    for option in options:
        name = option.removeprefix("--").partition("=")[0]
        if name.partition(".")[0] not in known:
            raise ValueError(f"The policy has no setting {name!r}. {suggest(name, known)}")


def read_policy(folder: Path, config: PreTrainedConfig) -> PreTrainedPolicy:
    """The policy of a checkpoint; unlike with LeRobot's factory no weight may be missing.

    Raises:
        ValueError: If the weights are damaged or are not those of the policy.
    """
    try:
        return get_policy_class(config.type).from_pretrained(folder, config=config, strict=True)
    except SafetensorError as error:
        raise ValueError(f"{folder / WEIGHTS} is damaged; {WAY_OUT}") from error
    except RuntimeError as error:  # torch's, for weights of other names or shapes
        raise ValueError(
            f"The weights in {folder} do not fit the config.json beside them; {WAY_OUT}"
        ) from error


def read_processors(
    folder: Path, config: PreTrainedConfig
) -> tuple[PolicyProcessorPipeline, PolicyProcessorPipeline]:
    """The pipelines to the policy's inputs and from its outputs.

    Raises:
        ValueError: If one of their files is damaged, or has a step that is not LeRobot's or a
            plug-in's.
    """
    for name in PROCESSORS:
        _check_steps(folder / name)
    overrides = {"device_processor": {"device": config.device}}
    with _damage_reported(f"A processor in {folder}"):
        return make_pre_post_processors(config, str(folder), preprocessor_overrides=overrides)


def _check_steps(file: Path) -> None:
    """LeRobot would import and call whatever a step without a registered name says it is."""
    with _damage_reported(file):
        steps = [step.get("registry_name") for step in _read_json(file)["steps"]]
    for name in steps:
        if name not in ProcessorStepRegistry.list():
            raise ValueError(f"{file} has a step that is not registered, so it is not run.")


def _read_json(file: Path) -> dict[str, Any]:
    with _damage_reported(file):
        content = json.loads(file.read_text())
        if not isinstance(content, dict):
            raise TypeError("It must be an object.")
    return content


@contextmanager
def _damage_reported(what: Path | str) -> Iterator[None]:
    """Whatever a file's reader raises becomes one sentence about the file."""
    try:
        yield
    except READING_ERRORS as error:
        raise ValueError(f"{what} is damaged; {WAY_OUT}") from error

"""The features that LeRobot gives to policies of instance sets, checked before use."""

from collections.abc import Callable

from lerobot.configs import PolicyFeature, PreTrainedConfig
from lerobot.utils.constants import ACTION
from torch import Tensor

from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PREFERENCE
from kitchen_prefs.instances import COLUMNS, DESCRIBED_COLUMNS, as_rows

POSE_SIZE = 7  # position and quaternion


def check_sets_and_poses(config: PreTrainedConfig) -> None:
    """Check that the inputs contain sets of instances and the outputs poses.

    Raises:
        ValueError: If a feature is missing or has another shape.
    """
    _check(config, OBS_INSTANCES, config.input_features, _is_set)
    _check(config, ACTION, config.output_features, lambda shape: shape == (POSE_SIZE,))


def has_descriptions(config: PreTrainedConfig) -> bool:
    """Whether a policy's sets have rows of 21 numbers, as in the second tier."""
    feature = (config.input_features or {}).get(OBS_INSTANCES)
    return feature is not None and _has_columns(tuple(feature.shape), DESCRIBED_COLUMNS)


def _is_set(shape: tuple[int, ...]) -> bool:
    """Whether a shape is (N, 13) or (N, 21), or flat, as data sets have it."""
    return _has_columns(shape, COLUMNS) or _has_columns(shape, DESCRIBED_COLUMNS)


def _has_columns(shape: tuple[int, ...], columns: int) -> bool:
    return shape[1:] == (columns,) or (len(shape) == 1 and shape[0] % columns == 0)


def _check(
    config: PreTrainedConfig,
    name: str,
    features: dict[str, PolicyFeature] | None,
    fits: Callable[[tuple], bool],
) -> None:
    feature = (features or {}).get(name)
    if feature is None or not fits(tuple(feature.shape)):
        found = "is missing" if feature is None else f"has the shape {tuple(feature.shape)}"
        raise ValueError(
            f"{config.type!r} takes sets of rows of {COLUMNS} or {DESCRIBED_COLUMNS} numbers and "
            f"returns a pose of {POSE_SIZE}, but {name!r} {found}; use a data set or an "
            "environment of kitchen_prefs."
        )


def observed_sets(batch: dict[str, Tensor]) -> Tensor:
    """The observed sets of B environments, (B, N, 13), see `observed`."""
    return as_rows(observed(batch, OBS_INSTANCES))


def observed(batch: dict[str, Tensor], key: str) -> Tensor:
    """An entry of an environment's observation.

    Args:
        batch: The observation.
        key: The entry's key.

    Returns:
        The entry.

    Raises:
        ValueError: If the observation does not contain it.
    """
    if key not in batch:
        track = " on the track --track=privileged (--env.track)" * (key == OBS_PREFERENCE)
        raise ValueError(
            f"The policy needs {key!r}, which the observation does not contain; roll it out in an "
            f"environment of kitchen_prefs{track}."
        )
    return batch[key]

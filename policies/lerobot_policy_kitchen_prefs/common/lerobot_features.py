"""What LeRobot hands to a policy of instance sets: checked before it is used."""

from collections.abc import Callable

from lerobot.configs import PolicyFeature, PreTrainedConfig
from lerobot.utils.constants import ACTION
from torch import Tensor

from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PREFERENCE
from kitchen_prefs.instances import COLUMNS

POSE_SIZE = 7  # position and quaternion


def check_sets_and_poses(config: PreTrainedConfig) -> None:
    """Check that there are sets of instances to look at and poses to return.

    Raises:
        ValueError: If a feature is missing or has another shape.
    """
    _check(config, OBS_INSTANCES, config.input_features, lambda shape: shape[1:] == (COLUMNS,))
    _check(config, ACTION, config.output_features, lambda shape: shape == (POSE_SIZE,))


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
            f"{config.type!r} reads sets of rows of {COLUMNS} numbers and answers with a pose of "
            f"{POSE_SIZE}, but {name!r} {found}; use a data set or an environment of kitchen_prefs."
        )


def shown(batch: dict[str, Tensor], key: str) -> Tensor:
    """What an environment shows under a key.

    Raises:
        ValueError: If it does not show it.
    """
    if key not in batch:
        track = " on the track --track=privileged (--env.track)" * (key == OBS_PREFERENCE)
        raise ValueError(
            f"The policy needs {key!r}, which the environment does not show; roll it out in an "
            f"environment of kitchen_prefs{track}."
        )
    return batch[key]

"""What LeRobot hands to a policy of instance sets: checked before it is used."""

from lerobot.configs import PolicyFeature, PreTrainedConfig
from lerobot.utils.constants import ACTION
from torch import Tensor

from kitchen_prefs.environment_config import OBS_INSTANCES, OBS_PREFERENCE
from kitchen_prefs.instances import COLUMNS

POSE_SIZE = 7  # position and quaternion


def check_sets_and_poses(config: PreTrainedConfig) -> None:
    """Check that there are sets of instances to look at and poses to return.

    Raises:
        ValueError: If a feature is missing or has another shape.
    """
    sets = (config.input_features or {}).get(OBS_INSTANCES)
    pose = (config.output_features or {}).get(ACTION)
    _check(config, OBS_INSTANCES, sets, fits=sets is not None and sets.shape[1:] == (COLUMNS,))
    _check(config, ACTION, pose, fits=pose is not None and tuple(pose.shape) == (POSE_SIZE,))


def _check(config: PreTrainedConfig, name: str, feature: PolicyFeature | None, fits: bool) -> None:
    if not fits:
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
        track = " on the privileged track (--env.track=privileged)" * (key == OBS_PREFERENCE)
        raise ValueError(
            f"The policy needs {key!r}, which the environment does not show; roll it out in an "
            f"environment of kitchen_prefs{track}."
        )
    return batch[key]

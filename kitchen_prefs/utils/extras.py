"""The extra `scene`: MuJoCo, which pictures and physics need and the kitchen does not."""

from importlib.util import find_spec


def require_mujoco() -> None:
    """Make sure that MuJoCo is installed.

    Raises:
        OSError: If it is not; the message says how to install it.
    """
    if find_spec("mujoco") is None:
        raise OSError(
            "Pictures and physics need MuJoCo: "
            "`pip install 'lerobot_policy_kitchen_prefs[scene]'`. Everything else works without it."
        )

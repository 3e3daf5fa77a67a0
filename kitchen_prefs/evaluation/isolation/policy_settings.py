"""The arguments of `load_policy` for a process that sees its checkpoint alone."""

from collections.abc import Sequence
from typing import Any

from kitchen_prefs.evaluation.checkpoint_reading import find_checkpoint, find_policy_below
from kitchen_prefs.evaluation.policy_options import check_one_policy


def policy_settings(
    path: str | None,
    policy_type: str | None,
    options: Sequence[str],
    track: str | None,
    split: str = "seen",
) -> dict[str, Any]:
    """Find a policy's checkpoint, and the one below it if it is an adapter.

    Nothing of the policy is imported. What is on the hub is downloaded.

    Args:
        path: A checkpoint.
        policy_type: The type of a policy that needs no training.
        options: Settings of the policy to override, as in `--rule=expert`.
        track: The track of the environment, see `load_policy`.
        split: The split whose observations it has to fit.

    Raises:
        ValueError: If not exactly one of `path` and `policy_type` is given, or if a checkpoint is
            not there.
    """
    check_one_policy(path, policy_type)
    folder = find_checkpoint(path) if path else None
    below = find_policy_below(folder) if folder else None
    return {
        "path": folder and str(folder.resolve()),
        "below": below and str(below.resolve()),
        "policy_type": policy_type,
        "options": list(options),
        "track": track,
        "split": split,
    }

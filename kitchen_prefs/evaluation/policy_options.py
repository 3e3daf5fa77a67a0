"""The options that name a policy, shared by `evaluate`, `leaderboard submit` and `verify`.

They are separate from `policy_loading`, which takes seconds to import torch and LeRobot, so that
`--help` stays quick.
"""

from collections.abc import Sequence
from typing import Annotated

import typer

PolicyPath = Annotated[
    str | None, typer.Option("--policy.path", help="A checkpoint's folder, or its hub name.")
]
PolicyType = Annotated[
    str | None, typer.Option("--policy.type", help="A policy that needs no training.")
]
# Lets a command accept undeclared options: the policy's settings.
ANY_SETTING = {"allow_extra_args": True, "ignore_unknown_options": True}


def settings_of(arguments: Sequence[str]) -> list[str]:
    """The settings of a policy among a command's undeclared arguments.

    Args:
        arguments: Such as `--policy.rule=symbolic`.

    Returns:
        The same without the prefix, as in `--rule=symbolic`.

    Raises:
        ValueError: If an argument is not a setting of the policy.
    """
    for argument in arguments:
        if not argument.startswith("--policy.") or "=" not in argument:
            raise ValueError(
                f"There is no option {argument!r}; a policy's setting is --policy.SETTING=VALUE."
            )
    return [f"--{argument.removeprefix('--policy.')}" for argument in arguments]


def check_one_policy(path: str | None, policy_type: str | None) -> None:
    """Make sure that either a checkpoint or a type of policy is given.

    Raises:
        ValueError: If none or both are.
    """
    if (path is None) == (policy_type is None):
        raise ValueError("Give either --policy.path=CHECKPOINT or --policy.type=TYPE.")

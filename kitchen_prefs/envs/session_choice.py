"""Which session a `reset()` starts."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from kitchen_prefs.simulation.sessions import FRESH_USERS
from kitchen_prefs.utils.suggestions import suggest

RESET_OPTIONS = ("session", "salt")
# LeRobot's mark of a new rollout (lerobot.envs.utils.NEW_ROLLOUT_OPTION); it changes nothing here.
LEROBOT_OPTION = "lerobot_new_rollout"
# An unseeded reset draws its salt below the salts of re-runs, and never the published salt 0.
FRESH_SALTS = FRESH_USERS


def choose_session(
    sessions: Sequence[int],
    seed: int | None,
    options: dict[str, Any],
    generator: Callable[[], np.random.Generator],
) -> tuple[int, int]:
    """The index and the session seed (salt) of the session to start.

    A named session or a seed starts a published session, with salt 0, unless a salt is given. With
    neither, the session is drawn from the environment's generator; so is the salt, if none is
    given, and then it is a fresh session, which no published split has.

    Args:
        sessions: The sessions of the environment, as their split counts them.
        seed: The seed of `reset()`; it names one of the sessions, modulo their number.
        options: The options of `reset()`: a session's index and a salt.
        generator: Gives the environment's generator, which is used if nothing names a session.

    Raises:
        ValueError: If an option is unknown or is not a whole number.
    """
    _check_options(options)
    if "session" in options:
        return int(options["session"]), int(options.get("salt", 0))
    if seed is not None:
        return sessions[seed % len(sessions)], int(options.get("salt", 0))
    random = generator()
    salt = options["salt"] if "salt" in options else random.integers(1, FRESH_SALTS)
    return sessions[int(random.integers(len(sessions)))], int(salt)


def _check_options(options: dict[str, Any]) -> None:
    for name, value in options.items():
        if name == LEROBOT_OPTION:
            continue
        if name not in RESET_OPTIONS:
            raise ValueError(
                f"reset() knows no option {name!r}. {suggest(str(name), RESET_OPTIONS)}"
            )
        if not isinstance(value, int | np.integer):
            raise ValueError(f"The option {name!r} is a whole number, not {value!r}.")

"""The shapes of observations and actions."""

from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Space

from kitchen_prefs import instances
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE_SIZE, STATE_SIZE
from kitchen_prefs.simulation import layout


def observation_space(track: str, prompts: int, flat: bool = False) -> Dict:
    """What the environment shows on a track, with a number of demonstrations in the prompt.

    With `flat`, the rows of the set stand one after the other, (936,), as in the data sets.
    """
    sets = (instances.FLAT_SIZE,) if flat else (instances.CAPACITY, instances.COLUMNS)
    spaces: dict[str, Space[Any]] = {
        "instances": _unbounded(*sets),
        "environment_state": _unbounded(ENVIRONMENT_STATE_SIZE),
        "agent_pos": _unbounded(STATE_SIZE),
        "prompt": _unbounded(prompts * instances.PROMPT_CAPACITY, instances.PROMPT_COLUMNS),
    }
    if track == "privileged":
        spaces["preference"] = _unbounded(1)
    return Dict(spaces)


def action_space() -> Box:
    """A pose: position (m) in the kitchen's workspace and quaternion (wxyz).

    The environment carries out actions beyond these bounds too, as the nearest row; libraries
    such as Stable-Baselines3 ask for bounds.
    """
    low, high = (*layout.WORKSPACE_LOW, -1, -1, -1, -1), (*layout.WORKSPACE_HIGH, 1, 1, 1, 1)
    return Box(np.array(low, np.float32), np.array(high, np.float32), dtype=np.float32)


def _unbounded(*shape: int) -> Box:
    return Box(-np.inf, np.inf, shape, np.float32)

"""The shapes of observations and actions."""

from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Space

from kitchen_prefs import instances
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE_SIZE, STATE_SIZE


def observation_space(track: str, prompts: int) -> Dict:
    """What the environment shows on a track, with a number of demonstrations in the prompt."""
    spaces: dict[str, Space[Any]] = {
        "instances": _unbounded(instances.CAPACITY, instances.COLUMNS),
        "environment_state": _unbounded(ENVIRONMENT_STATE_SIZE),
        "agent_pos": _unbounded(STATE_SIZE),
        "prompt": _unbounded(prompts * instances.PROMPT_CAPACITY, instances.PROMPT_COLUMNS),
    }
    if track == "privileged":
        spaces["preference"] = _unbounded(1)
    return Dict(spaces)


def action_space() -> Box:
    """A pose: position (m) and quaternion (wxyz)."""
    return _unbounded(7)


def _unbounded(*shape: int) -> Box:
    return Box(-np.inf, np.inf, shape, np.float32)

"""The environment for reinforcement learning: an action is a row, rewards are the paper's."""

from typing import Any

import gymnasium
import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.simulator import LIMIT_FACTOR
from kitchen_prefs.metrics import packing_efficiency
from kitchen_prefs.simulation.sessions import expert_trajectory

# The sessions of the demonstrations, so that imitation and reinforcement learning share users and
# dishes.
SPLIT, SALT = "train", 0
SHOWN = (
    "instances",
    "preference",
)  # not the prompt: it would fill PPO's rollout buffer
NOT_CHOOSABLE = "This row cannot be chosen in this decision."


class RowActions(gymnasium.Wrapper):
    """`DishwasherLoading` on the privileged track, whose actions are rows of the instance set.

    A row that cannot be chosen, padding included, is refused: it counts as a decision and changes
    nothing. At an episode's end `info["PE"]` is its packing
    efficiency.
    """

    env: DishwasherLoading

    def __init__(self) -> None:
        super().__init__(DishwasherLoading(SPLIT, track="privileged"))
        spaces = self.env.observation_space
        assert isinstance(spaces, gymnasium.spaces.Dict)
        self.observation_space = gymnasium.spaces.Dict({key: spaces[key] for key in SHOWN})
        self.action_space = gymnasium.spaces.Discrete(instances.CAPACITY)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
        """Start a published session; see `DishwasherLoading.reset`."""
        observation, info = self.env.reset(seed=seed, options={"salt": SALT, **(options or {})})
        self._seen = {key: observation[key] for key in SHOWN}
        self._left = LIMIT_FACTOR * len(expert_trajectory(self.env.session).decisions)
        return self._seen, info

    def step(self, action: int) -> tuple[dict[str, np.ndarray], float, bool, bool, dict[str, Any]]:
        """Choose a row; see `DishwasherLoading.step`."""
        self._left -= 1
        rows = self._seen["instances"]
        reward, terminated, info = 0.0, False, {"refusal": NOT_CHOOSABLE, "is_success": False}
        if instances.choosable(rows)[action]:
            observation, reward, terminated, _, info = self.env.step(rows[action, instances.POSE])
            self._seen = {key: observation[key] for key in SHOWN}
        truncated = not terminated and self._left == 0
        if terminated or truncated:
            info["PE"] = packing_efficiency(self.env.episode())
        return self._seen, reward, terminated, truncated, info

    def action_masks(self) -> np.ndarray:
        """The rows that the kitchen would carry out, (N,) bool; sb3-contrib calls this.

        An oracle: no evaluated policy observes which dishes block which placements.
        """
        return self.env.simulator.feasible_rows()

"""The environment for reinforcement learning: an action is a row, rewards are the paper's."""

from typing import Any

import gymnasium
import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.episode_simulator import LIMIT_FACTOR
from kitchen_prefs.metrics import packing_efficiency
from kitchen_prefs.simulation.sessions import expert_trajectory

# The sessions that demonstrations are of, so that imitation and reinforcement see the same users
# and dishes.
SPLIT, SALT = "train", 0
SHOWN = ("instances", "preference")  # not the prompt: its megabytes would fill the memory of PPO
NOT_CHOOSABLE = "This decision does not choose among such rows."


class RowActions(gymnasium.Wrapper):
    """`DishwasherLoading` on the privileged track, whose actions are rows of the instance set.

    A row that the decision may not choose, padding included, changes nothing, counts as a decision
    and is refused, as what the kitchen refuses. At an episode's end `info["PE"]` is its packing
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
        """Start a published session, any one without a seed; see `DishwasherLoading.reset`."""
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
        """The rows that the kitchen would carry out, (N,) bool; sb3-contrib asks for them.

        An oracle: no evaluated policy observes which dishes block which placements.
        """
        return self.env.simulator.feasible_rows()

"""What the environments of both tiers share: steps, refusals, ends and pictures."""

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded

from kitchen_prefs.envs.session_choice import choose_session
from kitchen_prefs.envs.simulator import Simulator
from kitchen_prefs.envs.spaces import action_space
from kitchen_prefs.rendering.state import SceneState, scene_of

# One constant for both data versions: LeRobot reads the first environment's for its whole batch.
# Twice the longest expert episode of any published session is less
# (tests/kitchen_prefs/envs/test_environment.py measures it).
MAX_EPISODE_STEPS = 160


class KitchenEnv(gymnasium.Env):
    """One step is one decision: pick an object, or, with a dish in hand, a place for it.

    A tier says how a session begins (`_begin`), what is observed, what a decision earns and what
    success is.

    Args:
        sessions: The indices of the sessions that `reset()` chooses from.
        render_mode: None or "rgb_array".
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 4}  # noqa: RUF012 (gymnasium's own form)
    _max_episode_steps = MAX_EPISODE_STEPS
    task = "kitchen_prefs"

    def __init__(self, sessions: Sequence[int], render_mode: str | None) -> None:
        self._sessions = sessions
        self.render_mode = render_mode
        self.action_space = action_space()
        self._simulator: Simulator | None = None
        self._renderer: Any = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
        """Start a session; `session_choice.choose_session` says which.

        Args:
            seed: Starts session `seed` modulo the number of sessions.
            options: `{"session": i, "salt": k}` starts session i with session seed (salt) k.

        Returns:
            The observation and the info.

        Raises:
            ValueError: If there is no such option or session.
        """
        super().reset(seed=seed)
        index, salt = choose_session(self._sessions, seed, options or {}, lambda: self.np_random)
        self._simulator = self._begin(index, salt)
        return self._observe(), self._info("", 0.0)

    def step(
        self, action: np.ndarray
    ) -> tuple[dict[str, np.ndarray], float, bool, bool, dict[str, Any]]:
        """Carry out one decision.

        Args:
            action: The chosen row's pose: position (m) and quaternion (wxyz), (7,).

        Returns:
            Observation, reward, terminated, truncated and info.

        Raises:
            ValueError: If the action has another shape or is not finite.
            ResetNeeded: If the episode has not begun or has ended.
        """
        simulator = self.simulator
        if simulator.terminated or simulator.truncated:
            raise ResetNeeded("The episode has ended; call reset() before the next step().")
        instance, distance = simulator.choose(action)
        gained = self._reward(instance)
        refusal = simulator.decide(instance, action)
        earned = 0.0 if refusal else gained
        info = self._info(refusal, distance)
        return self._observe(), earned, simulator.terminated, simulator.truncated, info

    def render(self) -> np.ndarray | None:
        """A picture of the kitchen, (H, W, 3) uint8, if `render_mode` is "rgb_array"."""
        if self.render_mode is None:
            return None
        if self._renderer is None:
            # MuJoCo and OpenGL are needed for pictures alone.
            from kitchen_prefs.rendering.renderer import Renderer

            self._renderer = Renderer(480, 360, "fast")
        return self._renderer.render(self.scene())

    def close(self) -> None:
        """Release the renderer."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    @property
    def simulator(self) -> Any:
        """The episode, from the last `reset` on.

        Raises:
            ResetNeeded: If there is none.
        """
        if self._simulator is None:
            raise ResetNeeded("The environment has no episode yet; call reset() first.")
        return self._simulator

    def digest(self) -> str:
        """A hash of the kitchen's state and of all decisions so far, as submissions hold it."""
        return self.simulator.digest()

    def scene(self, opened: bool = False) -> SceneState:
        """What a renderer draws; `opened` shows the load whatever is closed."""
        return scene_of(self.simulator.kitchen, opened)

    def _begin(self, index: int, salt: int) -> Simulator:
        """Start a session of the split."""
        raise NotImplementedError

    def _observe(self) -> dict[str, np.ndarray]:
        raise NotImplementedError

    def _reward(self, instance: int) -> float:
        """What a decision earns if the kitchen carries it out."""
        raise NotImplementedError

    def _is_success(self) -> bool:
        """Whether an episode that has ended by itself went as the user likes it."""
        raise NotImplementedError

    def _info(self, refusal: str, distance: float) -> dict[str, Any]:
        return {
            "is_success": self.simulator.terminated and self._is_success(),
            "refusal": refusal,
            "distance": distance,
            "session": self.simulator.session.index,
        }

"""The gymnasium environment: load the dishwasher as the user of the prompt does."""

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded

from kitchen_prefs import instances
from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.envs.given_prompt import GivenPrompt
from kitchen_prefs.envs.rewards import reward
from kitchen_prefs.envs.session_choice import choose_session
from kitchen_prefs.envs.spaces import action_space, observation_space
from kitchen_prefs.metrics import Episode, success
from kitchen_prefs.rendering.state import SceneState, scene_of
from kitchen_prefs.simulation.sessions import Session, make_session, prompt_sessions
from kitchen_prefs.splits import Split, get_split
from kitchen_prefs.utils.suggestions import suggest

TRACKS = ("standard", "privileged", "language")
TASK = "Load the dishwasher as this person likes it, from one demonstration."
# One constant for the data version: LeRobot reads the first environment's for its whole batch.
# Twice the longest expert episode of any published session is less
# (tests/kitchen_prefs/envs/test_environment.py measures it).
MAX_EPISODE_STEPS = 160


class DishwasherLoading(gymnasium.Env):
    """`kitchen_prefs/DishwasherLoading-v0`: the sessions of one split.

    One step is one decision: pick an object, or, with a dish in hand, a place for it.

    | observation | shape | content |
    |---|---|---|
    | `instances` | (72, 13) | the visible set, zero-padded, see `kitchen_prefs.instances` |
    | `environment_state` | (53,) | a flat summary of the set, see `envs.observations` |
    | `agent_pos` | (11,) | joints (rad, m), category in hand, decision index |
    | `prompt` | (1664 n, 14) | n prompt demonstrations, zero-padded; column 13 marks choices |
    | `preference` | (1,) | the preference's label; on the privileged track alone |

    All observations are float32. An **action** is a pose, (7,): position in m and quaternion
    (wxyz). The environment takes the nearest row that the decision may choose
    (`envs.actions.nearest_row`). The **reward** is 1 for picking a dish of the category that the
    preference calls for and for a free placement in its preferred rack, else 0
    (`envs.rewards`). A decision that the kitchen refuses changes nothing and earns 0.

    An episode is **terminated** when every dish has arrived and is put away, both racks are in and
    the door is closed. It is **truncated** at twice the expert's number of decisions.

    | info | content |
    |---|---|
    | `is_success` | whether PE is 1 and everything is closed |
    | `refusal` | why the kitchen did not carry the decision out, else "" |
    | `distance` | from the action to the row that was taken: m, plus 0.1 m a radian |
    | `session` | the session's index in its split |

    Args:
        split: The split whose sessions are simulated.
        track: "standard" shows nothing of the preference but the prompt, "privileged" adds the
            label, "language" gives the preference in words as `task_description`.
        prompt_of: "same", or "other" for a prompt of another preference (the metric prompt use).
        prompts: The number n of demonstrations in a prompt.
        task_id: The label of the preference whose sessions alone are simulated, as `Split.tasks`
            has them; None for all sessions of the split.
        given: A prompt instead of the benchmark's; then every user has its preference.
        flat: Whether `instances` is flat, (936,), as LeRobot's data sets have it.
        render_mode: None or "rgb_array".

    Raises:
        ValueError: If an argument is unknown.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 4}  # noqa: RUF012 (gymnasium's own form)
    _max_episode_steps = MAX_EPISODE_STEPS
    task = "kitchen_prefs"

    def __init__(
        self,
        split: str = "seen",
        track: str = "standard",
        prompt_of: str = "same",
        prompts: int = 1,
        task_id: int | None = None,
        given: GivenPrompt | None = None,
        flat: bool = False,
        render_mode: str | None = None,
    ) -> None:
        if track not in TRACKS:
            raise ValueError(f"There is no track {track!r}. {suggest(track, TRACKS)}")
        self.split = get_split(split)
        self._sessions = _sessions_of(self.split, task_id)
        self.track = track
        self.prompt_of = prompt_of
        self.prompts = prompts
        self.given = given
        self.render_mode = render_mode
        self.action_space = action_space()
        self.observation_space = observation_space(track, prompts, flat)
        self._set_shape = self.observation_space["instances"].shape
        self._simulator: EpisodeSimulator | None = None
        self._renderer: Any = None

    @property
    def task_description(self) -> str:
        """One constant sentence, or the preference in words on the language track."""
        return self.session.preference.in_words if self.track == "language" else TASK

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
        preference = self.given.preference if self.given else None
        session = make_session(self.split.name, index, salt, preference)
        self._simulator = EpisodeSimulator(session)
        self._prompt = self.given.rows if self.given else self._prompt_for(session)
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
        gained = reward(simulator.view, self.session.preference, instance)
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
    def simulator(self) -> EpisodeSimulator:
        """The episode, from the last `reset` on.

        Raises:
            ResetNeeded: If there is none.
        """
        if self._simulator is None:
            raise ResetNeeded("The environment has no episode yet; call reset() first.")
        return self._simulator

    @property
    def session(self) -> Session:
        """The session of the present episode."""
        return self.simulator.session

    def episode(self) -> Episode:
        """The facts of the episode so far, from which every metric is computed."""
        return self.simulator.episode()

    def digest(self) -> str:
        """A hash of the kitchen's state and of all decisions so far, as submissions hold it."""
        return self.simulator.digest()

    def scene(self, opened: bool = False) -> SceneState:
        """What a renderer draws; `opened` shows the load whatever is closed."""
        return scene_of(self.simulator.kitchen, opened)

    def _prompt_for(self, session: Session) -> np.ndarray:
        sources = prompt_sessions(session, self.prompt_of, self.prompts)
        return np.concatenate([prompt_of(source) for source in sources])

    def _observe(self) -> dict[str, np.ndarray]:
        observation = self.simulator.observation
        environment_state, state = self.simulator.observer.flat(observation)
        observed = {
            "instances": instances.pack(observation.rows).reshape(self._set_shape),
            "environment_state": environment_state,
            "agent_pos": state,
            "prompt": self._prompt.copy(),
        }
        if self.track == "privileged":
            observed["preference"] = np.array([self.session.label], dtype=np.float32)
        return observed

    def _info(self, refusal: str, distance: float) -> dict[str, Any]:
        return {
            "is_success": self.simulator.terminated and success(self.episode()),
            "refusal": refusal,
            "distance": distance,
            "session": self.session.index,
        }


def _sessions_of(split: Split, task_id: int | None) -> Sequence[int]:
    if task_id is None:
        return range(split.sessions)
    if task_id not in split.tasks:
        raise ValueError(
            f"The split {split.name} has no task {task_id}; it has {sorted(split.tasks)}."
        )
    return split.tasks[task_id]

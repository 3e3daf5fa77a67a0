"""The gymnasium environment: load the dishwasher as the person of the prompt does.

One step is one decision: pick an object, or, with a dish in hand, a place for it. An action is a
pose; the environment takes the nearest row that the decision may choose.
"""

from typing import Any

import gymnasium
import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE_SIZE, STATE_SIZE
from kitchen_prefs.envs.rewards import reward
from kitchen_prefs.metrics import Episode, success
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.state import SceneState
from kitchen_prefs.simulation.expert import KitchenView, choose
from kitchen_prefs.simulation.kitchen import Location
from kitchen_prefs.simulation.sessions import Session, make_session, prompt_sessions
from kitchen_prefs.splits import get_split
from kitchen_prefs.utils.suggestions import suggest

TRACKS = ("standard", "privileged", "language")
TASK = "Load the dishwasher as this person likes it, from one demonstration."
# One constant for the data version: LeRobot reads the first environment's for its whole batch.
# Twice the longest expert of any published session is less (tests/kitchen_prefs/test_environment.py
# measures it).
MAX_EPISODE_STEPS = 160
FRESH_SALTS = 2**31  # an unseeded reset draws its salt below this, never the published salt 0
RESET_OPTIONS = ("session", "salt")
# LeRobot's mark of a new rollout (lerobot.envs.utils.NEW_ROLLOUT_OPTION); it changes nothing here.
LEROBOT_OPTION = "lerobot_new_rollout"


class DishwasherLoading(gymnasium.Env):
    """Sessions of one split, as `kitchen_prefs/DishwasherLoading-v0`.

    Observations: `instances` (N, 13) the visible set, padded; `environment_state` (E,) a flat
    summary of it; `agent_pos` (S,) joints, category in hand, decision index; `prompt` (P, 14) the
    whole prompt demonstration, padded, or several of them, one below the other; on the privileged
    track also `preference` (1,), the label.

    Args:
        split: The split whose sessions are played.
        track: "standard" tells nothing of the preference but the prompt, "privileged" adds the
            label, "language" gives the preference in words as `task_description`.
        prompt_of: "same", or "other" for a prompt of another preference (the metric prompt use).
        prompts: How many demonstrations prompt an episode.
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
        render_mode: str | None = None,
    ) -> None:
        if track not in TRACKS:
            raise ValueError(f"There is no track {track!r}. {suggest(track, TRACKS)}")
        self.split = get_split(split)
        self.track = track
        self.prompt_of = prompt_of
        self.prompts = prompts
        self.render_mode = render_mode
        self.action_space = _box(7)
        self.observation_space = gymnasium.spaces.Dict(
            {
                "instances": _box(instances.CAPACITY, instances.COLUMNS),
                "environment_state": _box(ENVIRONMENT_STATE_SIZE),
                "agent_pos": _box(STATE_SIZE),
                "prompt": _box(prompts * instances.PROMPT_CAPACITY, instances.PROMPT_COLUMNS),
                **({"preference": _box(1)} if track == "privileged" else {}),
            }
        )
        self._renderer: Any = None

    @property
    def task_description(self) -> str:
        """One constant sentence, or the preference in words on the language track."""
        return self.session.preference.in_words if self.track == "language" else TASK

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
        """Start a session.

        Args:
            seed: Starts session `seed` modulo the split's size. Without a seed or a session, one
                is drawn from this environment's own generator; unless a salt is given, so is the
                salt, and the session is a fresh one, which no published split has.
            options: `{"session": i, "salt": k}` starts session i of salt k. The salt is 0 if only a
                session or a seed is given.

        Returns:
            The observation and the info.

        Raises:
            ValueError: If an option is unknown or is not a whole number, or if there is no such
                session.
        """
        super().reset(seed=seed)
        self._start(*self._which_session(seed, options or {}))
        return self._observe(), self._info("", 0.0)

    def step(
        self, action: np.ndarray
    ) -> tuple[dict[str, np.ndarray], float, bool, bool, dict[str, Any]]:
        """Carry out one decision.

        Args:
            action: The chosen row's pose: position (m) and quaternion (wxyz), (7,).

        Returns:
            Observation, reward, terminated, truncated and info; `info["refusal"]` says why the
            kitchen did not carry the decision out ("" if it did), `info["distance"]` how far the
            action was from the row that was taken (m, plus 0.1 m a radian).

        Raises:
            ValueError: If the action has another shape or is not finite.
        """
        instance, distance = self._simulator.choose(action)
        gained = reward(self._view, self.session.preference, instance)
        refusal = self._simulator.decide(instance, action)
        earned = gained if not refusal else 0.0
        info = self._info(refusal, distance)
        return self._observe(), earned, self._simulator.terminated, self._simulator.truncated, info

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
        """Give the renderer back."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    # What rollouts and scores read ------------------------------------------------------------

    @property
    def session(self) -> Session:
        """The session that is being played."""
        return self._simulator.session

    def instance_of(self, action: np.ndarray) -> int:
        """The instance that an action would choose now."""
        return self._simulator.choose(action)[0]

    def expert_action(self) -> np.ndarray:
        """The action with which the expert would go on from here, (7,)."""
        seen = self._simulator.seen
        row = seen.row_of(choose(self._view, self.session.preference))
        return seen.rows[row, instances.POSE]

    def feasible_rows(self) -> np.ndarray:
        """The rows that the kitchen would carry out now, (N,) bool.

        An oracle, which no track tells: it knows, for one, which placements a dish blocks.
        """
        seen = self._simulator.seen
        feasible = np.zeros(instances.CAPACITY, dtype=bool)
        for row in np.flatnonzero(instances.choosable(seen.rows)):
            feasible[row] = not self._simulator.kitchen.refusal(int(seen.ids[row]))
        return feasible

    def scene(self, opened: bool = False) -> SceneState:
        """What a renderer draws.

        Args:
            opened: Draw the door open and both racks pulled out, whatever they are, so that a
                picture shows what is in them.
        """
        kitchen = self._simulator.kitchen
        poses = kitchen.pose if opened else kitchen.pose_in_world()
        dishes = tuple(
            (CATEGORIES[kitchen.dishes.category[i]], pose[:3], pose[3:])
            for i, pose in enumerate(poses)
            if kitchen.location[i] != Location.NOT_ARRIVED
        )
        joints = (kitchen.door_open, kitchen.out == "bottom", kitchen.out == "top")
        return SceneState(*((True, True, True) if opened else joints), dishes)

    def digest(self) -> str:
        """A hash of the kitchen's state and of the decisions that led to it."""
        return self._simulator.digest()

    def episode(self) -> Episode:
        """The facts of the episode so far, from which every metric is computed."""
        return self._simulator.episode()

    # Inside -----------------------------------------------------------------------------------

    def _which_session(self, seed: int | None, options: dict[str, Any]) -> tuple[int, int]:
        """The index and the salt of the session to start."""
        _check_options(options)
        if "session" in options:
            return int(options["session"]), int(options.get("salt", 0))
        if seed is not None:
            return seed % self.split.sessions, int(options.get("salt", 0))
        salt = options["salt"] if "salt" in options else self.np_random.integers(1, FRESH_SALTS)
        return int(self.np_random.integers(self.split.sessions)), int(salt)

    def _start(self, index: int, salt: int) -> None:
        session = make_session(self.split.name, index, salt)
        self._simulator = EpisodeSimulator(session)
        self._view = KitchenView(self._simulator.kitchen)
        sources = prompt_sessions(session, self.prompt_of, self.prompts)
        self._prompt = np.concatenate([prompt_of(source) for source in sources])

    def _observe(self) -> dict[str, np.ndarray]:
        seen = self._simulator.seen
        environment_state, state = self._simulator.observer.flat(seen)
        observation = {
            "instances": instances.pack(seen.rows),
            "environment_state": environment_state,
            "agent_pos": state,
            "prompt": self._prompt.copy(),
        }
        if self.track == "privileged":
            observation["preference"] = np.array([self.session.label], dtype=np.float32)
        return observation

    def _info(self, refusal: str, distance: float) -> dict[str, Any]:
        return {
            "is_success": self._simulator.terminated and success(self.episode()),
            "refusal": refusal,
            "distance": distance,
            "session": self.session.index,
        }


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


def _box(*shape: int) -> gymnasium.spaces.Box:
    return gymnasium.spaces.Box(-np.inf, np.inf, shape, np.float32)

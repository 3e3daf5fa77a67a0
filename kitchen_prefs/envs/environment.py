"""The gymnasium environment: load the dishwasher as the user of the prompt does."""

from collections.abc import Sequence

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.envs.given_prompt import GivenPrompt
from kitchen_prefs.envs.kitchen_env import KitchenEnv
from kitchen_prefs.envs.rewards import reward
from kitchen_prefs.envs.spaces import observation_space
from kitchen_prefs.metrics import Episode, success
from kitchen_prefs.simulation.sessions import Session, make_session, prompt_sessions
from kitchen_prefs.splits import Split, get_split
from kitchen_prefs.utils.suggestions import suggest

TRACKS = ("standard", "privileged", "language")
TASK = "Load the dishwasher as this person likes it, from one demonstration."


class DishwasherLoading(KitchenEnv):
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
        super().__init__(_sessions_of(self.split, task_id), render_mode)
        self.track = track
        self.prompt_of = prompt_of
        self.prompts = prompts
        self.given = given
        self.observation_space = observation_space(track, prompts, flat)
        self._set_shape = self.observation_space["instances"].shape

    @property
    def task_description(self) -> str:
        """One constant sentence, or the preference in words on the language track."""
        return self.session.preference.in_words if self.track == "language" else TASK

    @property
    def session(self) -> Session:
        """The session of the present episode."""
        return self.simulator.session

    def episode(self) -> Episode:
        """The facts of the episode so far, from which every metric is computed."""
        return self.simulator.episode()

    def _begin(self, index: int, salt: int) -> EpisodeSimulator:
        preference = self.given.preference if self.given else None
        session = make_session(self.split.name, index, salt, preference)
        self._prompt = self.given.rows if self.given else self._prompt_for(session)
        return EpisodeSimulator(session)

    def _reward(self, instance: int) -> float:
        return reward(self.simulator.view, self.session.preference, instance)

    def _is_success(self) -> bool:
        return success(self.episode())

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


def _sessions_of(split: Split, task_id: int | None) -> Sequence[int]:
    if task_id is None:
        return range(split.sessions)
    if task_id not in split.tasks:
        raise ValueError(
            f"The split {split.name} has no task {task_id}; it has {sorted(split.tasks)}."
        )
    return split.tasks[task_id]

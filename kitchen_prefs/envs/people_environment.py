"""The gymnasium environment of the second tier: people with rules on attributes."""

import numpy as np
from gymnasium.spaces import Box, Dict

from kitchen_prefs import instances
from kitchen_prefs.envs.kitchen_env import KitchenEnv
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE_SIZE
from kitchen_prefs.envs.people_demonstrations import people_prompt_of, with_evening
from kitchen_prefs.envs.people_observations import PEOPLE_STATE
from kitchen_prefs.envs.people_simulator import PeopleSimulator
from kitchen_prefs.metrics.people_episode import PeopleEpisode, success
from kitchen_prefs.people.sessions import PeopleSession, make_people_session
from kitchen_prefs.people.splits import get_people_split

PEOPLE_TASK = "Load the dishwasher as this person likes it, from her demonstrations."


class DishwasherPeople(KitchenEnv):
    """`kitchen_prefs/DishwasherPeople-v0`: the sessions of one split of the second tier.

    One step is one decision: pick an object, or, with a dish in hand, a place for it.

    | observation | shape | content |
    |---|---|---|
    | `instances` | (76, 21) | the visible set, zero-padded, see `kitchen_prefs.instances` |
    | `environment_state` | (53,) | a flat summary of the set, without attributes |
    | `agent_pos` | (12,) | joints (rad, m), category in hand, decision index, evening |
    | `prompt` | (2048 n, 22) | the split's n demonstrations, zero-padded; column 21 marks choices |

    All observations are float32. `evening` is the number of the prompt whose user is to be served,
    0 but on `people_evening`, where the prompts are of two users. An **action** is a pose, (7,), as
    in the first tier. The **reward** is 1 for picking a dish that the user would take now or one of
    its rank, and for a free placement in the zone, or the sink, where the dish belongs now, else 0.

    An episode is **terminated** when every dish has arrived and is put away, both racks are in and
    the door is closed. It is **truncated** at twice the expert's number of decisions. The info is
    that of the first tier; `is_success` asks for Where of 1.

    Args:
        split: The split whose sessions are simulated.
        flat: Whether `instances` is flat, (1596,), as LeRobot's data sets have it.
        render_mode: None or "rgb_array".

    Raises:
        ValueError: If the split is unknown.
    """

    def __init__(
        self, split: str = "people_unseen", flat: bool = False, render_mode: str | None = None
    ) -> None:
        self.split = get_people_split(split)
        super().__init__(range(self.split.sessions), render_mode)
        self.observation_space = people_observation_space(self.split.prompts, flat)
        self._set_shape = self.observation_space["instances"].shape

    @property
    def task_description(self) -> str:
        """One constant sentence."""
        return PEOPLE_TASK

    @property
    def session(self) -> PeopleSession:
        """The session of the present episode."""
        return self.simulator.session

    def episode(self) -> PeopleEpisode:
        """The facts of the episode so far, from which every metric is computed."""
        return self.simulator.episode()

    def _begin(self, index: int, salt: int) -> PeopleSimulator:
        session = make_people_session(self.split.name, index, salt)
        self._prompt = np.concatenate([people_prompt_of(shown) for shown in session.prompts])
        return PeopleSimulator(session)

    def _reward(self, instance: int) -> float:
        return float(self.simulator.is_right(instance))

    def _is_success(self) -> bool:
        return success(self.episode())

    def _observe(self) -> dict[str, np.ndarray]:
        observation = self.simulator.observation
        environment_state, state = self.simulator.observer.flat(observation)
        return {
            "instances": instances.pack(observation.rows).reshape(self._set_shape),
            "environment_state": environment_state,
            "agent_pos": with_evening(state, self.session.evening),
            "prompt": self._prompt.copy(),
        }


def people_observation_space(prompts: int, flat: bool) -> Dict:
    """What the environment shows, with a number of demonstrations in the prompt."""
    rows = (instances.DESCRIBED_CAPACITY, instances.DESCRIBED_COLUMNS)
    flat_rows = (instances.DESCRIBED_FLAT_SIZE,)
    capacity = prompts * instances.PEOPLE_PROMPT_CAPACITY
    shapes = {
        "instances": flat_rows if flat else rows,
        "environment_state": (ENVIRONMENT_STATE_SIZE,),
        "agent_pos": (len(PEOPLE_STATE),),
        "prompt": (capacity, instances.DESCRIBED_COLUMNS + 1),
    }
    return Dict({key: Box(-np.inf, np.inf, shape, np.float32) for key, shape in shapes.items()})

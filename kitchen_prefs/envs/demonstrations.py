"""The expert's demonstration of a session: one frame a decision, for data sets and prompts."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.observations import Observer
from kitchen_prefs.envs.rewards import reward
from kitchen_prefs.simulation.expert import KitchenView
from kitchen_prefs.simulation.kitchen import Kitchen
from kitchen_prefs.simulation.sessions import Session, expert_trajectory


@dataclass(frozen=True)
class Demonstration:
    """The expert's episode of a session, T decisions.

    Attributes:
        instances: The padded instance sets, (T, N, 13) float32.
        environment_state: (T, E) float32, see `observations.ENVIRONMENT_STATE`.
        state: (T, S) float32, see `observations.STATE`.
        action: The chosen row's pose, (T, 7) float32.
        chosen_index: The chosen row, (T,) int64.
        reward: The paper's dense reward, (T,) float32.
        done: True at the last decision, (T,) bool.
        success: True at the last decision, (T,) bool.
        preference: The preference's label.
        task: The preference in words.
    """

    instances: np.ndarray
    environment_state: np.ndarray
    state: np.ndarray
    action: np.ndarray
    chosen_index: np.ndarray
    reward: np.ndarray
    done: np.ndarray
    success: np.ndarray
    preference: int
    task: str


def demonstrate(session: Session) -> Demonstration:
    """Record the expert's demonstration of a session."""
    kitchen = Kitchen(session.dishes)
    observer = Observer(kitchen, session.generator("order"), None)
    view = KitchenView(kitchen)
    observations, flats, chosen, rewards = [], [], [], []
    for instance in expert_trajectory(session).decisions:
        observation = observer.observe()
        observations.append(observation)
        flats.append(observer.flat(observation))
        chosen.append(observation.row_of(instance))
        rewards.append(reward(view, session.preference, instance))
        kitchen.decide(instance)
    last = np.arange(len(chosen)) == len(chosen) - 1
    rows = [observation.rows[row] for observation, row in zip(observations, chosen, strict=True)]
    return Demonstration(
        instances=np.stack([instances.pack(observation.rows) for observation in observations]),
        environment_state=np.stack([environment_state for environment_state, _ in flats]),
        state=np.stack([state for _, state in flats]),
        action=np.stack(rows)[:, instances.POSE],
        chosen_index=np.array(chosen, dtype=np.int64),
        reward=np.array(rewards, dtype=np.float32),
        done=last,
        success=last,
        preference=session.label,
        task=session.preference.in_words,
    )


@lru_cache(maxsize=1024)
def prompt_of(session: Session) -> np.ndarray:
    """A session's demonstration as a prompt.

    Returns:
        The sets of all its decisions, one below the other and padded, with a last column that marks
        the chosen rows, (P, 14) float32, read-only.
    """
    demonstration = demonstrate(session)
    sets = []
    for padded, chosen in zip(demonstration.instances, demonstration.chosen_index, strict=True):
        rows = instances.unpad(padded)  # (n, 13)
        mark = np.arange(len(rows)) == chosen
        sets.append(np.column_stack([rows, mark]))
    prompt = instances.pack(np.concatenate(sets), instances.PROMPT_CAPACITY)
    prompt.flags.writeable = False
    return prompt

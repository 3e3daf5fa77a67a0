"""Demonstrations, the expert's and others: one frame a decision, for data sets and prompts."""

from collections.abc import Callable, Iterable, Sequence
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
    """An episode of a session, by the expert or by a person, T decisions.

    Attributes:
        instances: The padded instance sets, (T, N, D) float32.
        environment_state: (T, E) float32, see `observations.ENVIRONMENT_STATE`.
        state: (T, S) float32, see `observations.STATE`.
        action: The chosen row's pose, (T, 7) float32.
        chosen_index: The chosen row, (T,) int64.
        reward: The paper's dense reward, (T,) float32.
        done: True at the last decision, (T,) bool.
        success: True at the last decision if everything is then put away and closed, (T,) bool.
        preference: The preference's label; in the second tier the user's number in the split.
        task: The preference, or the user, in words.
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
    return record(session, expert_trajectory(session).decisions)


def record(session: Session, decisions: Sequence[int]) -> Demonstration:
    """Record decisions in a session as a demonstration.

    Args:
        session: Where they are taken; its preference gives rewards, label and task.
        decisions: The chosen instances, whoever chose them, T of them.

    Raises:
        ValueError: If there are none, or if the kitchen refuses one.
    """
    kitchen = Kitchen(session.dishes)
    view = KitchenView(kitchen)
    return record_in(
        kitchen,
        Observer(kitchen, session.generator("order"), None),
        decisions,
        reward_of=lambda instance: reward(view, session.preference, instance),
        label=session.label,
        task=session.preference.in_words,
    )


def record_in(
    kitchen: Kitchen,
    observer: Observer,
    decisions: Sequence[int],
    reward_of: Callable[[int], float],
    label: int,
    task: str,
) -> Demonstration:
    """Record decisions in a kitchen of either tier as a demonstration.

    Args:
        kitchen: Where they are taken, which this changes.
        observer: Observes it.
        decisions: The chosen instances, T of them.
        reward_of: What a decision earns that is about to be taken.
        label: The label of the preference or the user.
        task: The preference or the user in words.

    Raises:
        ValueError: If there are no decisions, or if the kitchen refuses one.
    """
    if not decisions:
        raise ValueError("A demonstration has at least one decision.")
    observations, flats, rewards = [], [], []
    chosen: list[int] = []
    for instance in decisions:
        if refusal := kitchen.refusal(instance):
            raise ValueError(f"The kitchen refuses decision {len(chosen) + 1}: {refusal}")
        observation = observer.observe()
        observations.append(observation)
        flats.append(observer.flat(observation))
        chosen.append(observation.row_of(instance))
        rewards.append(reward_of(instance))
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
        success=last & kitchen.finished,
        preference=label,
        task=task,
    )


@lru_cache(maxsize=1024)
def prompt_of(session: Session) -> np.ndarray:
    """A session's demonstration by the expert as a prompt, see `as_prompt`."""
    return as_prompt(demonstrate(session))


def as_prompt(demonstration: Demonstration) -> np.ndarray:
    """A demonstration as a prompt.

    Returns:
        The sets of all its decisions, one below the other and padded, with a last column that marks
        the chosen rows, (P, D + 1) float32, read-only.

    Raises:
        ValueError: If it has more rows than a prompt.
    """
    return marked_prompt(demonstration.instances, demonstration.chosen_index)


def marked_prompt(sets: Iterable[np.ndarray], chosen: Iterable[int]) -> np.ndarray:
    """A prompt of padded sets, (T, N, D) or flat, and of their chosen rows, (T,); see `as_prompt`.

    Raises:
        ValueError: If they have more rows than a prompt.
    """
    parts = []
    for padded, choice in zip(sets, chosen, strict=True):
        rows = instances.unpad(padded)  # (n, D)
        mark = np.arange(len(rows)) == choice
        parts.append(np.column_stack([rows, mark]))
    capacity = instances.PROMPT_CAPACITIES[rows.shape[1]]
    prompt = instances.pack(np.concatenate(parts), capacity)
    prompt.flags.writeable = False
    return prompt

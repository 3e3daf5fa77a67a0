"""Demonstrations of the second tier, for data sets and prompts."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from kitchen_prefs.envs.demonstrations import Demonstration, marked_prompt, record_in
from kitchen_prefs.envs.people_observations import DescribedObserver
from kitchen_prefs.envs.people_simulator import PeopleSimulator
from kitchen_prefs.people.sessions import PeopleSession, UserDemonstration, people_table
from kitchen_prefs.people.splits import get_people_split
from kitchen_prefs.people.words import user_in_words
from kitchen_prefs.simulation.kitchen import Kitchen


def demonstrate_people(session: PeopleSession) -> Demonstration:
    """Record how a session's user loads its dishes, as the environment shows and rewards it."""
    simulator = PeopleSimulator(session)
    demonstration = record_in(
        simulator.kitchen,
        DescribedObserver(simulator.kitchen, session.generator("order")),
        session.expert.trajectory.decisions,
        reward_of=lambda instance: float(simulator.is_right(instance)),
        label=get_people_split(session.split).user(session.index),
        task=user_in_words(session.user),
    )
    return replace(demonstration, state=with_evening(demonstration.state, session.evening))


def with_evening(state: np.ndarray, evening: int) -> np.ndarray:
    """States with the number of the prompt whose user is to be served, (..., S) -> (..., S + 1)."""
    return np.append(state, np.full_like(state[..., :1], evening), axis=-1)


@lru_cache(maxsize=1024)
def people_prompt_of(shown: UserDemonstration) -> np.ndarray:
    """A user's demonstration as a prompt.

    The rows of a set come in an order of their own, drawn from the dishes alone, so that a prompt
    is the same in every process.

    Returns:
        The sets of all its decisions, one below the other and padded, with a last column that marks
        the chosen rows, (2048, 22) float32, read-only.
    """
    kitchen = Kitchen(shown.dishes, people_table())
    seed = np.ascontiguousarray(shown.dishes.pose).view(np.uint32).ravel()
    observer = DescribedObserver(kitchen, np.random.default_rng(seed))
    sets, chosen = [], []
    for instance in shown.trajectory.decisions:
        observation = observer.observe()
        sets.append(observation.rows)
        chosen.append(observation.row_of(instance))
        kitchen.decide(instance)
    return marked_prompt(sets, chosen)

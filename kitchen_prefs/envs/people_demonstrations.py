"""Demonstrations of the second tier as prompts."""

from functools import lru_cache

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.people_observations import DescribedObserver
from kitchen_prefs.people.sessions import UserDemonstration, people_table
from kitchen_prefs.simulation.kitchen import Kitchen


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
    parts = []
    for instance in shown.trajectory.decisions:
        observation = observer.observe()
        mark = observation.ids == instance
        parts.append(np.column_stack([observation.rows, mark]))
        kitchen.decide(instance)
    prompt = instances.pack(np.concatenate(parts), instances.PEOPLE_PROMPT_CAPACITY)
    prompt.flags.writeable = False
    return prompt

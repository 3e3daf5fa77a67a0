"""What readers see of a user of the second tier, read from the rows of a prompt."""

from collections.abc import Iterator

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.people.evidence import Evidence, evidence_of
from kitchen_prefs.people.sessions import people_table
from kitchen_prefs.people.splits import PROMPTS_OF_TWO_USERS
from kitchen_prefs.people.yardsticks import Shown, shown_in
from kitchen_prefs.simulation.kitchen import Kitchen
from lerobot_policy_kitchen_prefs.rules.observed_dishes import counter_rows, dishes_of
from lerobot_policy_kitchen_prefs.rules.observed_kitchen import instance_at
from lerobot_policy_kitchen_prefs.rules.preference_inference import decisions_of

Decision = tuple[np.ndarray, int]  # an instance set, (n, 21), and its chosen row


def what_is_shown(prompt: np.ndarray, evening: int) -> Shown:
    """Read a user's demonstrations.

    Args:
        prompt: The demonstrations, one below the other, (R, 22), padded.
        evening: Which of them is of the user, if they are of two.
    """
    shown = list(demonstrations_of(prompt))
    if len(shown) == PROMPTS_OF_TWO_USERS:
        shown = [shown[evening]]
    return shown_in([read_demonstration(one) for one in shown])


def demonstrations_of(prompt: np.ndarray) -> Iterator[list[Decision]]:
    """Split a prompt, (R, 22), into its demonstrations."""
    decisions: list[Decision] = []
    for rows, chosen in decisions_of(prompt):
        if decisions and rows[0, instances.DECISION] == 0:
            yield decisions
            decisions = []
        decisions.append((rows, chosen))
    yield decisions


def read_demonstration(shown: list[Decision]) -> tuple[Kitchen, list[int], Evidence]:
    """Simulate a demonstration again: the kitchen as it is left, the decisions, what they say."""
    arrived, present = _arrivals([rows for rows, _ in shown])
    dishes = dishes_of(arrived, present)
    kitchen = Kitchen(dishes, people_table())
    decisions = []
    for rows, chosen in shown:
        decisions.append(instance_at(kitchen, rows[chosen, instances.POSE]))
        kitchen.decide(decisions[-1])
    return kitchen, decisions, evidence_of(dishes, people_table(), decisions)


def _arrivals(sets: list[np.ndarray]) -> tuple[np.ndarray, int]:
    """The dishes on the counter in the order in which they arrive, (n, 21), and how many at first.

    A dish is known by its pose, which it keeps until it is placed.
    """
    arrived = np.empty((0, instances.DESCRIBED_COLUMNS), np.float32)
    for rows in sets:
        waiting = counter_rows(rows)
        poses = waiting[:, None, instances.POSE], arrived[None, :, instances.POSE]
        known = (poses[0] == poses[1]).all(axis=2).any(axis=1)
        arrived = np.concatenate([arrived, _by_pose(waiting[~known])])
    return arrived, len(counter_rows(sets[0]))


def _by_pose(rows: np.ndarray) -> np.ndarray:
    """Rows in the order of their poses: that of a set is random."""
    return rows[np.lexsort(rows[:, instances.POSE].T)]

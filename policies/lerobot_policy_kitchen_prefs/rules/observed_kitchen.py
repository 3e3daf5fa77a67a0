"""The kitchen of the second tier in the state that an instance set shows.

A closed rack is not visible; it holds what it held when it was last out. Dishes in the sink are
left out: they bear on no decision.
"""

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.actions import nearest_row
from kitchen_prefs.envs.observations import DOOR_ROWS, RACK_ROWS
from kitchen_prefs.envs.people_observations import DescribedObserver
from kitchen_prefs.people.sessions import people_table
from kitchen_prefs.preferences import RACKS
from kitchen_prefs.simulation.kitchen import (
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    RACK_INSTANCE,
    Kitchen,
)
from lerobot_policy_kitchen_prefs.rules.observed_dishes import (
    counter_rows,
    dishes_of,
    looks_of,
    racked_rows,
)
from lerobot_policy_kitchen_prefs.rules.observed_view import find_object, placement_at

RackMemory = dict[str, np.ndarray]  # the dishes that each rack held when it was last out, (k, 21)


def observed_kitchen(rows: np.ndarray, memory: RackMemory) -> tuple[Kitchen, np.ndarray]:
    """Rebuild the kitchen.

    Args:
        rows: The instance set, (n, 21), unpadded.
        memory: What the racks held, updated here.

    Returns:
        The kitchen and the rows of its dishes, those on the counter first, (d, 21).
    """
    _, door_open = find_object(rows, DOOR_ROWS)
    open_rack = next((rack for rack in RACKS if find_object(rows, RACK_ROWS[rack])[1]), None)
    if open_rack is not None:
        memory[open_rack] = racked_rows(rows)
    waiting = counter_rows(rows)
    known = np.concatenate([waiting, *memory.values()])
    kitchen = Kitchen(dishes_of(known, present=len(known)), people_table())
    decisions = [DOOR, *_loading(kitchen, memory, len(waiting))]
    decisions += [DOOR] if not door_open else []
    decisions += [RACK_INSTANCE[open_rack]] if open_rack is not None else []
    places = rows[rows[:, instances.IS_PLACE] > 0]
    if len(places):
        decisions.append(FIRST_DISH + _first_alike(places[:1], waiting))
    for instance in decisions:
        kitchen.decide(instance)
    return kitchen, known


def instance_at(kitchen: Kitchen, pose: np.ndarray) -> int:
    """The instance of a kitchen that a pose, (7,), chooses."""
    shown = DescribedObserver(kitchen, np.random.default_rng(0)).observe()
    return int(shown.ids[nearest_row(shown.rows, pose)[0]])


def pose_of(kitchen: Kitchen, instance: int) -> np.ndarray:
    """The pose that chooses an instance of a kitchen, (7,)."""
    shown = DescribedObserver(kitchen, np.random.default_rng(0)).observe()
    return shown.rows[shown.row_of(instance), instances.POSE]


def _loading(kitchen: Kitchen, memory: RackMemory, first: int) -> list[int]:
    """Decisions that put dishes, from a first one on, where the racks hold them."""
    decisions, dish = [], first
    for rack, held in memory.items():
        poses = kitchen.table.pose[rack]
        decisions.append(RACK_INSTANCE[rack])
        for pose in held[:, instances.POSE]:
            among = kitchen.table.of_category[kitchen.dishes.category[dish]]
            place = FIRST_PLACEMENT[rack] + placement_at(pose, poses, among)
            decisions += [FIRST_DISH + dish, place]
            dish += 1
        decisions.append(RACK_INSTANCE[rack])
    return decisions


def _first_alike(row: np.ndarray, rows: np.ndarray) -> int:
    """The first of some rows, (n, 21), with the look of one, (1, 21)."""
    return int(np.abs(looks_of(rows) - looks_of(row)).sum(axis=1).argmin())

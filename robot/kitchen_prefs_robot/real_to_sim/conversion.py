"""One look as the state of the task: positions by the counter's map, heights and sizes by table."""

from collections.abc import Iterable, Mapping

import numpy as np

from kitchen_prefs.simulation.layout import COUNTER_HEIGHT, EXTENTS
from kitchen_prefs_robot.perception.detection import Detection
from kitchen_prefs_robot.perception.regions import open_drawer
from kitchen_prefs_robot.real_to_sim.work_area import WorkArea
from kitchen_prefs_robot.task.rows import placed
from kitchen_prefs_robot.task.state import DRAWERS, DrawersState, SeenDish


def to_drawers_state(
    detections: Iterable[Detection],
    openings: Mapping[str, float],
    counter: WorkArea,
) -> DrawersState:
    """Convert what was seen.

    Args:
        detections: The dishes that were seen.
        openings: How far each drawer is open, m.
        counter: Its map, as from `measure_counter`.

    Returns:
        The state in the kitchen's frame. A dish on the table, or on a stand, stands on the counter;
        one in a drawer has the drop pose; one that a person holds is the dish in hand. (What the
        arm holds is not seen but felt: leave the detections of the hand out, and replace
        `in_hand`.)
    """
    detections = list(detections)
    held = [nearest_category(found) for found in detections if found.place == "hand"]
    seen = (_seen(found, counter) for found in detections if found.place != "hand")
    return DrawersState(tuple(seen), open_drawer(openings), held[0] if held else None)


def nearest_category(found: Detection) -> str:
    """The category of a dish: by its colour or, if that is not known, by its size.

    The sizes of the kitchen are those that the policy has learned with: the nearest dish of the
    kitchen stands for the dish on the table.
    """
    if found.category is not None:
        return found.category
    size = np.sort(found.box.extents)  # (3,)
    return min(EXTENTS, key=lambda name: float(np.linalg.norm(np.sort(EXTENTS[name]) - size)))


def _seen(found: Detection, counter: WorkArea) -> SeenDish:
    category = nearest_category(found)
    if found.place in DRAWERS:
        return placed(category, found.place)
    x, y = counter.to_kitchen(found.box.middle[:2])
    z = COUNTER_HEIGHT + EXTENTS[category][2] / 2
    half = (found.box.yaw + counter.yaw) / 2
    turn = (float(np.cos(half)), 0.0, 0.0, float(np.sin(half)))
    return SeenDish(category, (float(x), float(y), z), turn, None)

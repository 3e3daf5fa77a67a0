"""The flat summary of a state, in the columns of the kitchen's data sets.

`kitchen_prefs.envs.observations` lists the columns. The open drawer is a rack that is pulled out,
and its drop pose a free placement; there is no door.
"""

import numpy as np

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation import layout
from kitchen_prefs_robot.task.rows import UPRIGHT, drop_position
from kitchen_prefs_robot.task.state import DrawersState, SeenDish


def summarise(state: DrawersState, decision: int) -> tuple[np.ndarray, np.ndarray]:
    """Summarise a state.

    Args:
        state: What is known.
        decision: The decision's index in its episode, from 0.

    Returns:
        The summary of the set, (E,) float32, see ENVIRONMENT_STATE; joints, category in hand and
        decision index, (S,) float32, see STATE.
    """
    on_table = [dish for dish in state.dishes if dish.drawer is None]
    in_drawer = [dish for dish in state.dishes if dish.drawer and dish.drawer == state.opened]
    joints = [0.0, *(layout.RACK_TRAVEL * (state.opened == name) for name in ("lower", "upper"))]
    in_hand = [float(state.in_hand == category) for category in CATEGORIES]
    environment_state = [
        *_counts(on_table),
        *(value for category in CATEGORIES for value in _nearest(on_table, category)),
        *joints,
        *in_hand,
        *_counts(in_drawer),
        *_free_placement(state),
    ]
    return (
        np.array(environment_state, dtype=np.float32),
        np.array([*joints, *in_hand, decision], dtype=np.float32),
    )


def _counts(dishes: list[SeenDish]) -> list[int]:
    return [sum(dish.category == category for dish in dishes) for category in CATEGORIES]


def _nearest(dishes: list[SeenDish], category: str) -> tuple[float, float, float]:
    """Where the dish of a category is that is nearest to where the kitchen has its sink."""

    def metres(position: tuple[float, float, float]) -> float:
        x, y = layout.SINK_CENTRE
        return float(np.hypot(position[0] - x, position[1] - y))

    positions = [dish.position for dish in dishes if dish.category == category]
    return min(positions, key=metres, default=(0.0, 0.0, 0.0))


def _free_placement(state: DrawersState) -> tuple[float, ...]:
    """Whether there is a place for the dish in hand, and its pose."""
    if state.in_hand is None or state.opened is None:
        return (0.0,) * 8
    return (1.0, *drop_position(state.opened), *UPRIGHT)

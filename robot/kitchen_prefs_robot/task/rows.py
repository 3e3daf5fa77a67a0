"""The instance set that a policy of the kitchen reads, made of a state of the drawers.

The drawers stand for the racks of the dishwasher, the upper one for the top one; the drop pose of
the open one is the only place for the dish in hand. The cabinet has no door and the table no sink,
so neither has a row.
"""

from collections.abc import Sequence

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.actions import nearest_row
from kitchen_prefs.envs.observations import RACK_ROWS
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.kitchen import rack_position
from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, Toggle, choices
from kitchen_prefs_robot.task.state import DrawersState, SeenDish

RACK_OF = {"upper": "top", "lower": "bottom"}
UPRIGHT = (1.0, 0.0, 0.0, 0.0)  # wxyz


def drop_position(drawer: str) -> tuple[float, float, float]:
    """Where a dish is that was dropped into a drawer: in the middle of the open rack, m."""
    x, y, z = rack_position(RACK_OF[drawer], out=True)
    return (x, y, z + layout.RACK_HEIGHT / 2)


def placed(category: str, drawer: str) -> SeenDish:
    """A dish that was dropped into a drawer: upright at the drop pose."""
    return SeenDish(category, drop_position(drawer), UPRIGHT, drawer)


def observe(state: DrawersState, decision: int) -> np.ndarray:
    """The instance set of a decision.

    Args:
        state: What is known.
        decision: The decision's index in its episode, from 0.

    Returns:
        One row for each of `choices(state)`, in their order, (N, 13) float32. A closed drawer hides
        its dishes, as a closed rack does.
    """
    rows = np.stack([_row(state, choice) for choice in choices(state)])
    rows[:, instances.DECISION] = decision
    return rows


def chosen_decision(state: DrawersState, rows: np.ndarray, action: Sequence[float]) -> Decision:
    """The decision that a policy's action chooses: that of the nearest row.

    Args:
        state: The state that was observed.
        rows: Its instance set, (N, 13).
        action: A pose: position (m) and quaternion (wxyz), (7,).

    Raises:
        ValueError: If the action has another shape or is not finite.
    """
    return choices(state)[nearest_row(rows, action)[0]]


def prompt_of(sets: Sequence[np.ndarray], chosen: Sequence[int]) -> np.ndarray:
    """A demonstration as a prompt.

    Args:
        sets: The instance set of each decision, (N, 13) each.
        chosen: The row that each decision chose.

    Returns:
        The sets, one below the other and padded, with a last column that marks the chosen rows,
        (1664, 14) float32.
    """
    marked = [
        np.column_stack([rows, np.arange(len(rows)) == choice])
        for rows, choice in zip(sets, chosen, strict=True)
    ]
    return instances.pack(np.concatenate(marked), instances.PROMPT_CAPACITY)


def _row(state: DrawersState, choice: Decision) -> np.ndarray:
    """What a decision can name as a row, (13,)."""
    if isinstance(choice, Toggle):
        return RACK_ROWS[RACK_OF[choice.drawer]][int(state.opened == choice.drawer)].copy()
    row = np.zeros(instances.COLUMNS, dtype=np.float32)
    if isinstance(choice, Pick):
        dish = state.dishes[choice.dish]
        row[instances.EXTENTS] = layout.EXTENTS[dish.category]
        row[instances.POSE] = (*dish.position, *dish.quaternion)
        row[instances.IS_OBJECT] = 1
        return row
    assert isinstance(choice, Place)
    assert state.in_hand is not None
    row[instances.EXTENTS] = layout.EXTENTS[state.in_hand]
    row[instances.POSE] = (*drop_position(choice.drawer), *UPRIGHT)
    row[instances.IS_PLACE] = 1
    return row

"""The scripted expert: loads the drawers by a preference."""

import numpy as np

from kitchen_prefs.simulation.expert import nearness_to_sink
from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, Toggle
from kitchen_prefs_robot.task.preferences import DrawerPreference
from kitchen_prefs_robot.task.state import DrawersState, SeenDish


def choose(state: DrawersState, preference: DrawerPreference) -> Decision:
    """The expert's next decision.

    It opens the preferred drawer, puts the dishes of its categories in, in the preferred order, and
    closes it before it opens the other. Of like dishes it takes the one nearest to where the
    kitchen has its sink, as the kitchen's expert does.

    Args:
        state: What is known; not finished.
        preference: The user's preference, which names the categories of all dishes.
    """
    if state.in_hand is not None:
        assert state.opened is not None
        return Place(state.opened)
    waiting = {
        drawer: [
            number
            for number, dish in enumerate(state.dishes)
            if dish.drawer is None and preference.drawer_of[dish.category] == drawer
        ]
        for drawer in preference.drawers
    }
    if state.opened is None:
        return Toggle(next(drawer for drawer, dishes in waiting.items() if dishes))
    if not waiting[state.opened]:
        return Toggle(state.opened)

    def turn(number: int) -> tuple[int, tuple[float, ...]]:
        dish = state.dishes[number]
        return preference.rank_of[dish.category], nearness_to_sink(_pose(dish))

    return Pick(min(waiting[state.opened], key=turn))


def _pose(dish: SeenDish) -> np.ndarray:
    return np.array([*dish.position, *dish.quaternion])  # (7,)

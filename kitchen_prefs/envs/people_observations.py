"""Observations of the second tier: the first's rows, and what a dish is beside its category."""

import numpy as np

from kitchen_prefs.envs.observations import STATE, Observation, Observer
from kitchen_prefs.instances import COLUMNS, DESCRIBED_COLUMNS, MATERIAL, RGB, SOIL
from kitchen_prefs.people import attributes
from kitchen_prefs.people.attributes import DescribedDishes
from kitchen_prefs.simulation.kitchen import FIRST_DISH, SINK, Kitchen

PEOPLE_STATE = (*STATE, "evening: the prompt whose user is to be served")


class DescribedObserver(Observer):
    """Observes a kitchen of described dishes before each decision.

    Args:
        kitchen: The kitchen, which it never changes.
        order: Draws the order of the rows, anew for each decision.
    """

    def __init__(self, kitchen: Kitchen, order: np.random.Generator) -> None:
        super().__init__(kitchen, order, None)
        assert isinstance(kitchen.dishes, DescribedDishes)
        self._extents = kitchen.dishes.extents.astype(np.float32)  # (n, 3)
        self._described = described(kitchen.dishes)  # (n, 8)

    def observe(self) -> Observation:
        """The observation of the next decision, its rows (n, 21).

        The row of a place describes the dish in hand, as its extents do.
        """
        observation = super().observe()
        ids = observation.ids
        rows = np.zeros((len(ids), DESCRIBED_COLUMNS), dtype=np.float32)
        rows[:, :COLUMNS] = observation.rows
        dish = (ids >= FIRST_DISH) & (ids < SINK)
        rows[dish, COLUMNS:] = self._described[ids[dish] - FIRST_DISH]
        if self._kitchen.held is not None:
            rows[ids >= SINK, COLUMNS:] = self._described[self._kitchen.held]
        return Observation(rows, ids)


def described(dishes: DescribedDishes) -> np.ndarray:
    """The last eight columns of the dishes' rows: colour, material and soil, (n, 8) float32."""
    columns = np.zeros((len(dishes.category), DESCRIBED_COLUMNS), dtype=np.float32)
    columns[:, RGB] = attributes.RGB[dishes.colour]
    columns[:, MATERIAL] = np.eye(len(attributes.MATERIALS))[dishes.material]
    columns[:, SOIL] = dishes.greasy
    return columns[:, COLUMNS:]

"""Loads the dishes of the second tier by the plan of a reader, from observations alone."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kitchen_prefs.envs.actions import nearest_row
from kitchen_prefs.people.attributes import DescribedDishes
from kitchen_prefs.people.expert import PlanExpert
from kitchen_prefs.people.users import LoadingPlan
from lerobot_policy_kitchen_prefs.rules.observed_dishes import dishes_of, looks_of
from lerobot_policy_kitchen_prefs.rules.observed_kitchen import (
    RackMemory,
    observed_kitchen,
    pose_of,
)

Planner = Callable[[DescribedDishes], LoadingPlan]


class PlanFollower:
    """Chooses in one episode as the expert would with a plan; a dish is planned when first seen.

    Args:
        planner: Plans the loading of some dishes, each by itself.
    """

    def __init__(self, planner: Planner) -> None:
        self._planner = planner
        self._racks: RackMemory = {}
        self._planned: dict[bytes, tuple[int, float]] = {}  # the zone and the rank of each look
        self._first_plan: LoadingPlan | None = None  # says what concerns no dish by itself

    def __call__(self, rows: np.ndarray) -> int:
        """The row to choose.

        Args:
            rows: The instance set, (n, 21), unpadded.
        """
        kitchen, dishes = observed_kitchen(rows, self._racks)
        instance = PlanExpert(kitchen, self._plan(dishes)).choose()
        return nearest_row(rows, pose_of(kitchen, instance))[0]

    def _plan(self, rows: np.ndarray) -> LoadingPlan:
        """The plan for some dishes, (d, 21); those that look new are planned now."""
        looks = [look.tobytes() for look in looks_of(rows)]
        new = [i for i, look in enumerate(looks) if look not in self._planned]
        if new:
            plan = self._planner(dishes_of(rows[new], present=len(new)))
            self._first_plan = self._first_plan or plan
            for i, zone, rank in zip(new, plan.zones.tolist(), plan.ranks.tolist(), strict=True):
                self._planned[looks[i]] = zone, rank
        assert self._first_plan is not None, "At least one dish waits when an episode begins."
        return replace(
            self._first_plan,
            zones=np.array([self._planned[look][0] for look in looks], dtype=int),
            ranks=np.array([self._planned[look][1] for look in looks]),
        )

"""A rule's view of the kitchen: the expert's view, computed from the rows of one instance set."""

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.observations import DOOR_ROWS, EXTENTS, RACK_ROWS
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation.expert import Nearness, Option, nearness_to_corner, nearness_to_sink
from kitchen_prefs.simulation.kitchen import SINK_POSE, placement_table
from lerobot_policy_kitchen_prefs.common.categories import nearest_category
from lerobot_policy_kitchen_prefs.common.dish_locations import in_rack, on_counter


class Memory:
    """The placements that were blocked when each rack was last visible."""

    def __init__(self) -> None:
        self.blocked: dict[str, np.ndarray] = {}


class ObservedView:
    """A `kitchen_prefs.simulation.expert.View` whose choices are rows of the instance set.

    Args:
        rows: The instance set, (n, 13), unpadded.
        memory: The state of racks that were visible before, updated here; None ignores closed
            racks.
    """

    def __init__(self, rows: np.ndarray, memory: Memory | None = None) -> None:
        self._rows = rows
        self._poses = rows[:, instances.POSE]  # (n, 7)
        self._category = nearest_category(rows, EXTENTS)  # (n,)
        self.door, self.door_open = find_object(rows, DOOR_ROWS)
        found = {rack: find_object(rows, RACK_ROWS[rack]) for rack in RACKS}
        self.racks = {rack: row for rack, (row, _) in found.items()}
        self.open_rack = next((rack for rack, (_, out) in found.items() if out), None)
        places = np.flatnonzero(rows[:, instances.IS_PLACE] > 0)
        self.held = CATEGORIES[self._category[places[0]]] if len(places) else None
        in_sink = (self._poses[places] == SINK_POSE).all(axis=1)
        self.sink = int(places[in_sink][0]) if len(places) else -1
        self._placements = places[~in_sink]
        self._blocked = dict(memory.blocked) if memory else {}
        if self.open_rack is not None:
            self._blocked[self.open_rack] = self._blocked_in(self.open_rack)
        if memory is not None:
            memory.blocked = self._blocked

    def waiting(self) -> list[Option]:
        """The dishes on the counter."""
        return [
            self._option(row, nearness_to_sink(self._poses[row]))
            for row in self._dishes(on_counter(self._rows))
        ]

    def free_placements(self) -> list[Option]:
        """The free placements of the rack that is out for the category in hand."""
        if self.open_rack is None:
            return []
        table = placement_table()
        of_held = table.of_category[CATEGORIES.index(str(self.held))]
        return [
            self._option(row, nearness_to_corner(self._poses[row], self.open_rack))
            for row in self._placements
            if not self._blocked[self.open_rack][self._placement_at(self._poses[row], of_held)]
        ]

    def fits(self, rack: str, category: str) -> bool:
        """Whether a rack has a free placement; one that was never visible is assumed to."""
        if rack not in self._blocked:
            return True
        return not self._blocked[rack][
            placement_table().of_category[CATEGORIES.index(category)]
        ].all()

    def category(self, row: int) -> str:
        """The category of a dish or a place."""
        return CATEGORIES[self._category[row]]

    def _option(self, row: int, nearness: Nearness) -> Option:
        return Option(self.category(row), nearness, int(row))

    def _dishes(self, mask: np.ndarray) -> np.ndarray:
        """The dishes among the masked objects."""
        rows = np.flatnonzero(mask & (self._rows[:, instances.IS_OBJECT] > 0))
        return rows[~np.isin(rows, [self.door, *self.racks.values()])]

    def _blocked_in(self, rack: str) -> np.ndarray:
        table = placement_table()
        taken = [
            self._placement_at(self._poses[row], table.of_category[self._category[row]])
            for row in self._dishes(in_rack(self._rows))
        ]
        return np.any(table.blocks[taken], axis=0)

    def _placement_at(self, pose: np.ndarray, among: np.ndarray) -> int:
        assert self.open_rack is not None
        return placement_at(pose, placement_table().pose[self.open_rack], among)


def find_object(rows: np.ndarray, states: list[np.ndarray]) -> tuple[int, bool]:
    """The row of the door or a rack, and whether it is in the second of its two states.

    Args:
        rows: The instance set, (n, D).
        states: Its row in both states.

    Raises:
        ValueError: If the set lacks it.
    """
    for second, state in enumerate(states):
        same = (rows[:, : instances.DECISION] == state[: instances.DECISION]).all(axis=1)
        if same.any():
            return int(np.flatnonzero(same)[0]), bool(second)
    raise ValueError(
        "The instance set lacks the door or a rack; take it from an environment of kitchen_prefs."
    )


def placement_at(pose: np.ndarray, poses: np.ndarray, among: np.ndarray) -> int:
    """The placement with a dish's pose, (7,), among some, (k,) int, of a rack's, (P, 7)."""
    return int(among[np.abs(poses[among] - pose).sum(axis=1).argmin()])

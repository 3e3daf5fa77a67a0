"""What a rule sees of the kitchen: the expert's view, read from the rows of one instance set."""

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.observations import DOOR_ROWS, EXTENTS, RACK_ROWS
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.expert import Nearness, Option, nearness_to_corner, nearness_to_sink
from kitchen_prefs.simulation.kitchen import SINK_POSE, placement_table

# Dishes that stand higher than this are on the counter; those in a rack are a hand's breadth lower.
COUNTER_LEVEL = layout.COUNTER_HEIGHT - 0.1  # m


class Memory:
    """Which placements were blocked when a rack was last seen."""

    def __init__(self) -> None:
        self.blocked: dict[str, np.ndarray] = {}


class Sight:
    """A `kitchen_prefs.simulation.expert.View` whose choices are rows of the instance set.

    Args:
        rows: The instance set, (n, 13), unpadded.
        memory: What was seen before, brought up to date here; None forgets closed racks.
    """

    def __init__(self, rows: np.ndarray, memory: Memory | None = None) -> None:
        self._rows = rows
        self._poses = rows[:, instances.POSE]  # (n, 7)
        self._objects = rows[:, instances.IS_OBJECT] > 0
        self._category = _nearest_category(rows)  # (n,)
        self.door, self.door_open = self._find(DOOR_ROWS)
        found = {rack: self._find(RACK_ROWS[rack]) for rack in RACKS}
        self.racks = {rack: row for rack, (row, _) in found.items()}
        self.out = next((rack for rack, (_, out) in found.items() if out), None)
        places = np.flatnonzero(rows[:, instances.IS_PLACE] > 0)
        self.held = CATEGORIES[self._category[places[0]]] if len(places) else None
        in_sink = (self._poses[places] == SINK_POSE).all(axis=1)
        self.sink = int(places[in_sink][0]) if len(places) else -1
        self._placements = places[~in_sink]
        self._blocked = dict(memory.blocked) if memory else {}
        if self.out is not None:
            self._blocked[self.out] = self._blocked_in(self.out)
        if memory is not None:
            memory.blocked = self._blocked

    def waiting(self) -> list[Option]:
        """The dishes on the counter."""
        return [
            self._option(row, nearness_to_sink(self._poses[row]))
            for row in self._dishes(on_counter=True)
        ]

    def free_placements(self) -> list[Option]:
        """The free placements of the rack that is out for the category in hand."""
        if self.out is None:
            return []
        table = placement_table()
        of_held = table.of_category[CATEGORIES.index(str(self.held))]
        return [
            self._option(row, nearness_to_corner(self._poses[row], self.out))
            for row in self._placements
            if not self._blocked[self.out][self._placement_at(self._poses[row], of_held)]
        ]

    def fits(self, rack: str, category: str) -> bool:
        """Whether a rack has a free placement; one that was never seen is taken to have one."""
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

    def _dishes(self, on_counter: bool) -> np.ndarray:
        fixed = [self.door, *self.racks.values()]
        high = self._poses[:, 2] > COUNTER_LEVEL
        rows = np.flatnonzero(self._objects & (high == on_counter))
        return rows[~np.isin(rows, fixed)]

    def _find(self, states: list[np.ndarray]) -> tuple[int, bool]:
        """The row of the door or a rack, and whether it is in the second of its two states."""
        for second, state in enumerate(states):
            same = (self._rows[:, : instances.DECISION] == state[: instances.DECISION]).all(axis=1)
            if same.any():
                return int(np.flatnonzero(same)[0]), bool(second)
        raise ValueError("The instance set lacks the door or a rack; it is not of this kitchen.")

    def _blocked_in(self, rack: str) -> np.ndarray:
        table = placement_table()
        standing = self._dishes(on_counter=False)
        taken = [
            self._placement_at(self._poses[row], table.of_category[self._category[row]])
            for row in standing
        ]
        return np.any(table.blocks[taken], axis=0)

    def _placement_at(self, pose: np.ndarray, among: np.ndarray) -> int:
        """The placement of the rack that is out at which a dish stands."""
        assert self.out is not None
        poses = placement_table().pose[self.out][among]
        return int(among[np.abs(poses - pose).sum(axis=1).argmin()])


def _nearest_category(rows: np.ndarray) -> np.ndarray:
    """The category whose extents are nearest to each row's, (n,)."""
    differences = rows[:, None, instances.EXTENTS] - EXTENTS  # (n, 7, 3)
    return np.abs(differences).sum(axis=-1).argmin(axis=1)

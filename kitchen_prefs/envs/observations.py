"""Observations: the visible instances as rows in random order, and a flat summary of them.

The flat summary serves policies that cannot read a set, such as LeRobot's ACT. Its entries are
listed in ENVIRONMENT_STATE and STATE; it holds nothing that the visible set does not. Where
perception is noisy, its positions are too; its counts are exact, because the noise is too small to
confuse two categories.
"""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.preferences import CATEGORIES, RACKS, plural
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.expert import placement_nearness
from kitchen_prefs.simulation.kitchen import (
    BOTTOM_RACK,
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    SINK,
    SINK_POSE,
    TOP_RACK,
    Kitchen,
    Location,
    rack_position,
)

EXTENT_NOISE = 0.05  # standard deviation, relative (design of the `noisy` split)
POSITION_NOISE = 0.01  # standard deviation, m

STATE = (
    "door angle (rad)",
    "bottom rack (m)",
    "top rack (m)",
    *(f"{category} in hand" for category in CATEGORIES),
    "decision index",
)
ENVIRONMENT_STATE = (
    *(f"{plural(category)} on the counter" for category in CATEGORIES),
    *(
        f"{axis} of the {category} nearest to the sink (m)"
        for category in CATEGORIES
        for axis in "xyz"
    ),
    "door angle (rad)",
    "bottom rack (m)",
    "top rack (m)",
    *(f"{category} in hand" for category in CATEGORIES),
    *(f"{plural(category)} in the rack that is out" for category in CATEGORIES),
    "a free placement exists",
    *(
        f"{value} of the nearest free placement"
        for value in ("x", "y", "z", "qw", "qx", "qy", "qz")
    ),
)
STATE_SIZE = len(STATE)
ENVIRONMENT_STATE_SIZE = len(ENVIRONMENT_STATE)


@dataclass(frozen=True)
class Observation:
    """The observation of one decision.

    Attributes:
        rows: The instance set, (n, 13) float32, see `instances`.
        ids: The instance of each row, (n,) int.
    """

    rows: np.ndarray
    ids: np.ndarray

    def row_of(self, instance: int) -> int:
        """The row of a choosable instance."""
        return int(np.flatnonzero(self.ids == instance)[0])


class Observer:
    """Observes one session's kitchen before each decision.

    Args:
        kitchen: The kitchen, which it never changes.
        order: Draws the order of the rows, anew for each decision.
        noise: Draws the errors of perception; without it observations are exact.
    """

    def __init__(
        self, kitchen: Kitchen, order: np.random.Generator, noise: np.random.Generator | None
    ) -> None:
        self._kitchen = kitchen
        self._order = order
        self._noise = noise
        self._extents = EXTENTS[kitchen.dishes.category]  # (n, 3)
        self._decision = 0

    def observe(self) -> Observation:
        """The observation of the next decision."""
        dishes = self._kitchen.visible_dishes()
        extents, position = self._perceive()
        objects = self._object_rows(dishes, extents, position)  # (3 + d, 13)
        places, place_ids = self._place_rows(extents)  # (p, 13)
        ids = np.concatenate([OBJECT_IDS, FIRST_DISH + dishes, place_ids])
        rows = np.concatenate([objects, places])  # (n, 13)
        rows[:, instances.DECISION] = self._decision
        order = self._order.permutation(len(rows))
        self._decision += 1
        return Observation(rows[order], ids[order])

    def flat(self, observation: Observation) -> tuple[np.ndarray, np.ndarray]:
        """The last observation as flat vectors.

        Args:
            observation: The last observation; the kitchen has not changed since.

        Returns:
            The summary of the set, (E,) float32, see ENVIRONMENT_STATE; joints, category in hand
            and decision index, (S,) float32, see STATE.
        """
        dishes = self._kitchen.visible_dishes()
        rows = observation.rows[np.argsort(observation.ids)][
            len(OBJECT_IDS) : len(OBJECT_IDS) + len(dishes)
        ]
        decision = [self._decision - 1]
        state = np.concatenate([self._joints(), self._in_hand(), decision])  # (S,)
        return self._summary(dishes, rows), state.astype(np.float32)

    def _perceive(self) -> tuple[np.ndarray, np.ndarray]:
        """The perceived extents and position of each dish, (n, 3) each."""
        position = self._kitchen.pose[:, :3]
        if self._noise is None:
            return self._extents, position
        errors = self._noise.standard_normal((2, *position.shape))
        return self._extents * (1 + EXTENT_NOISE * errors[0]), position + POSITION_NOISE * errors[1]

    def _object_rows(
        self, dishes: np.ndarray, extents: np.ndarray, position: np.ndarray
    ) -> np.ndarray:
        kitchen = self._kitchen
        rows = np.zeros((len(OBJECT_IDS) + len(dishes), instances.COLUMNS), dtype=np.float32)
        rows[0] = DOOR_ROWS[int(kitchen.door_open)]
        rows[1] = RACK_ROWS["bottom"][int(kitchen.open_rack == "bottom")]
        rows[2] = RACK_ROWS["top"][int(kitchen.open_rack == "top")]
        rows[3:, instances.EXTENTS] = extents[dishes]
        rows[3:, instances.POSITION] = position[dishes]
        rows[3:, instances.QUATERNION] = kitchen.pose[dishes, 3:]
        rows[3:, instances.IS_OBJECT] = 1
        return rows

    def _place_rows(self, extents: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        kitchen = self._kitchen
        if kitchen.held is None:
            return np.empty((0, instances.COLUMNS), dtype=np.float32), np.empty(0, dtype=int)
        placements = kitchen.placements()
        rows = np.zeros((len(placements) + 1, instances.COLUMNS), dtype=np.float32)
        rows[:, instances.EXTENTS] = extents[kitchen.held]
        rows[:, instances.IS_PLACE] = 1
        rows[-1, instances.POSE] = SINK_POSE
        if kitchen.open_rack is None:
            return rows, np.array([SINK])
        rows[:-1, instances.POSE] = kitchen.table.pose[kitchen.open_rack][placements]
        return rows, np.append(FIRST_PLACEMENT[kitchen.open_rack] + placements, SINK)

    def _joints(self) -> np.ndarray:
        kitchen = self._kitchen
        door = layout.DOOR_OPEN_ANGLE * kitchen.door_open
        return np.array(
            [door, *(layout.RACK_TRAVEL * (kitchen.open_rack == rack) for rack in RACKS)]
        )

    def _in_hand(self) -> np.ndarray:
        in_hand = np.zeros(len(CATEGORIES))
        if self._kitchen.held is not None:
            in_hand[self._kitchen.dishes.category[self._kitchen.held]] = 1
        return in_hand

    def _summary(self, dishes: np.ndarray, rows: np.ndarray) -> np.ndarray:
        kitchen = self._kitchen
        category = kitchen.dishes.category[dishes]
        on_counter = kitchen.location[dishes] == Location.COUNTER
        count = np.bincount(category[on_counter], minlength=len(CATEGORIES))
        in_rack = np.bincount(category[~on_counter], minlength=len(CATEGORIES))
        nearest = np.zeros((len(CATEGORIES), 3))
        position = rows[:, instances.POSITION]  # (d, 3)
        metres = np.hypot(*(position[:, :2] - layout.SINK_CENTRE).T)  # (d,)
        far_to_near = np.argsort(-metres)
        far_to_near = far_to_near[on_counter[far_to_near]]
        nearest[category[far_to_near]] = position[far_to_near]  # the nearest is written last
        parts = (count, nearest.ravel(), self._joints(), self._in_hand(), in_rack)
        return np.concatenate([*parts, self._nearest_free()]).astype(np.float32)

    def _nearest_free(self) -> np.ndarray:
        kitchen = self._kitchen
        if kitchen.held is None or kitchen.open_rack is None:
            return np.zeros(8)
        rack = kitchen.open_rack
        free = kitchen.free(rack, int(kitchen.dishes.category[kitchen.held]))
        if len(free) == 0:
            return np.zeros(8)
        nearness = placement_nearness(kitchen.table)[rack]
        nearest = min(free.tolist(), key=nearness.__getitem__)
        return np.array([1, *kitchen.table.pose[rack][nearest]])


def _object_row(extents: tuple[float, float, float], pose: tuple[float, ...]) -> np.ndarray:
    return np.array([*extents, *pose, 0, 1, 0], dtype=np.float32)  # (13,)


def _door_pose(angle: float) -> tuple[float, ...]:
    """The pose of the door's centre when it is turned open by an angle in rad."""
    _, thickness, height = layout.DOOR_SIZE
    x, hinge_y, hinge_z = layout.DOOR_HINGE
    y, z = -thickness / 2, height / 2  # the closed door's centre, from the hinge
    cos, sin = np.cos(angle), np.sin(angle)
    position = (x, hinge_y + cos * y - sin * z, hinge_z + sin * y + cos * z)
    pose = (*position, np.cos(angle / 2), np.sin(angle / 2), 0, 0)
    return tuple(round(float(value), 6) for value in pose)


EXTENTS = np.array(
    [layout.EXTENTS[category] for category in CATEGORIES], dtype=np.float32
)  # (7, 3)
OBJECT_IDS = np.array([DOOR, BOTTOM_RACK, TOP_RACK])
DOOR_ROWS = [_object_row(layout.DOOR_SIZE, _door_pose(a)) for a in (0, layout.DOOR_OPEN_ANGLE)]
RACK_ROWS = {
    rack: [
        _object_row(
            (*layout.RACK_INNER, layout.RACK_HEIGHT), (*rack_position(rack, out), 1, 0, 0, 0)
        )
        for out in (False, True)
    ]
    for rack in RACKS
}

"""The kitchen: joints, where each dish is, and what a decision changes.

No randomness and no policy here. A decision names one instance; the kitchen carries it out or says
in a sentence why it cannot, and then nothing has changed.

Instances have numbers that never change within a session:

    0 door   1 bottom rack   2 top rack   3 + i dish i
    999 sink   1000 + k placement k of the bottom rack   2000 + k placement k of the top rack
"""

import hashlib
from dataclasses import dataclass
from enum import IntEnum
from functools import cache

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.placements import Placements, load_placements

DOOR, BOTTOM_RACK, TOP_RACK, FIRST_DISH = 0, 1, 2, 3
SINK = 999
FIRST_PLACEMENT = {"bottom": 1000, "top": 2000}
RACK_INSTANCE = {"bottom": BOTTOM_RACK, "top": TOP_RACK}
RACK_OF_INSTANCE = {instance: rack for rack, instance in RACK_INSTANCE.items()}

# Dishes that have not arrived start to arrive at the latest after this many completed actions, so
# that a policy which never clears the counter meets them too. The expert clears twenty dishes in 25
# actions.
ARRIVALS_AT_LATEST = 30


class Location(IntEnum):
    """Where a dish is."""

    NOT_ARRIVED = 0
    COUNTER = 1
    BOTTOM = 2
    TOP = 3
    SINK = 4


IN_RACK = {"bottom": Location.BOTTOM, "top": Location.TOP}


@dataclass(frozen=True, eq=False)
class Dishes:
    """The dishes of a session, in the order in which they arrive.

    Attributes:
        category: Index into CATEGORIES, (n,) int8.
        pose: Position (m) and quaternion (wxyz) on the counter, (n, 7) float32.
        present: How many stand on the counter at the start.
    """

    category: np.ndarray
    pose: np.ndarray
    present: int

    def digested(self) -> tuple[np.ndarray, ...]:
        """What a kitchen's digest tells of them beside their poses."""
        return (self.category,)


@dataclass(frozen=True, eq=False)
class PlacementTable:
    """The placements of both racks when they are pulled out, in the world.

    Attributes:
        category: Index into CATEGORIES, (P,) int8.
        pose: Position (m) and quaternion of each rack's placements, rack -> (P, 7) float32.
        blocks: Whether one placement's dish stands in another's way, (P, P) bool.
        of_category: The placements of each category, category index -> (k,) int.
    """

    category: np.ndarray
    pose: dict[str, np.ndarray]
    blocks: np.ndarray
    of_category: tuple[np.ndarray, ...]


@cache
def placement_table(scale: float = 1.0) -> PlacementTable:
    """The committed placements for dishes of a scale, where the pulled-out racks hold them."""
    placements: Placements = load_placements(scale)
    pose = {}
    for rack in RACKS:
        origin = np.array(rack_position(rack, out=True))
        position = placements.position + origin  # (P, 3)
        pose[rack] = np.hstack([position, placements.quaternion]).astype(np.float32)  # (P, 7)
    of_category = tuple(np.flatnonzero(placements.category == c) for c in range(len(CATEGORIES)))
    return PlacementTable(placements.category, pose, placements.blocks, of_category)


def rack_position(rack: str, out: bool) -> tuple[float, float, float]:
    """The origin of a rack's frame in the world, in metres."""
    x, y, z = layout.RACK_CLOSED[rack]
    return (x, y - layout.RACK_TRAVEL * out, z)


class Kitchen:
    """One session's kitchen.

    Args:
        dishes: The session's dishes.
        table: Where they can stand; the first tier's placements by default.

    Attributes:
        dishes: The session's dishes.
        table: Where they can stand.
        door_open: Whether the door is open.
        open_rack: The rack that is pulled out, or None.
        held: The dish in hand, or None. It stays where it was picked until it is placed.
        location: Where each dish is, (n,) int8 of `Location`.
        placement: The placement of each dish in a rack, else -1, (n,) int64.
        pose: The pose of each dish, (n, 7) float32; a racked dish as in the pulled-out rack.
        completed: Completed actions so far: toggles that worked and finished places.
    """

    def __init__(self, dishes: Dishes, table: PlacementTable | None = None) -> None:
        n = len(dishes.category)
        self.dishes = dishes
        self.table = table or placement_table()
        self.door_open = False
        self.open_rack: str | None = None
        self.held: int | None = None
        self.location = np.full(n, Location.NOT_ARRIVED, dtype=np.int8)
        self.location[: dishes.present] = Location.COUNTER
        self.placement = np.full(n, -1)
        self.pose = dishes.pose.copy()
        self.completed = 0
        self._arrived = dishes.present
        self._arriving = False
        self._blocked = {rack: np.zeros(len(self.table.category), dtype=bool) for rack in RACKS}

    # What is visible -------------------------------------------------------------------------

    def visible_dishes(self) -> np.ndarray:
        """The dishes on the counter or in the pulled-out rack, (k,) int."""
        visible = self.location == Location.COUNTER
        if self.open_rack is not None:
            visible |= self.location == IN_RACK[self.open_rack]
        return np.flatnonzero(visible)

    def placements(self) -> np.ndarray:
        """The placements of the category in hand in the pulled-out rack, free or not, (k,) int."""
        if self.held is None or self.open_rack is None:
            return np.empty(0, dtype=int)
        return self.table.of_category[self.dishes.category[self.held]]

    def free(self, rack: str, category: int) -> np.ndarray:
        """The placements of a category that no dish in the rack blocks, (k,) int."""
        placements = self.table.of_category[category]
        return placements[~self._blocked[rack][placements]]

    @property
    def counter(self) -> np.ndarray:
        """The dishes on the counter, the one in hand included, (k,) int."""
        return np.flatnonzero(self.location == Location.COUNTER)

    @property
    def all_arrived(self) -> bool:
        """Whether all dishes of the session have arrived."""
        return self._arrived == len(self.location)

    @property
    def closed(self) -> bool:
        """Whether both racks are in and the door is closed."""
        return self.open_rack is None and not self.door_open

    @property
    def finished(self) -> bool:
        """Whether everything has arrived, the counter is empty and everything is closed."""
        return self.closed and self.all_arrived and not (self.location == Location.COUNTER).any()

    # What a decision changes -----------------------------------------------------------------

    def decide(self, instance: int) -> str:
        """Carry out one decision.

        Args:
            instance: The number of the chosen instance. While a dish is in hand it is a place, else
                an object.

        Returns:
            An empty string, or why the decision could not be carried out.
        """
        refusal = self.refusal(instance)
        if not refusal:
            self._carry_out(instance)
        return refusal

    def refusal(self, instance: int) -> str:
        """Why a decision cannot be carried out now, or an empty string; nothing changes."""
        if self.held is not None:
            return self._refusal_of_place(instance)
        if instance == DOOR:
            return "" if self.open_rack is None else "The door moves only with both racks in."
        if instance in RACK_OF_INSTANCE:
            return self._refusal_of_rack(RACK_OF_INSTANCE[instance])
        dish = instance - FIRST_DISH
        if not 0 <= dish < len(self.location) or self.location[dish] != Location.COUNTER:
            return "Only a dish on the counter can be picked; one in a rack stays there."
        return ""

    def _refusal_of_rack(self, rack: str) -> str:
        if not self.door_open:
            return "A rack moves only with the door open."
        if self.open_rack not in (None, rack):
            return "A rack moves only with the other rack in."
        return ""

    def _refusal_of_place(self, instance: int) -> str:
        if instance == SINK:
            return ""
        if (
            self.open_rack is None
            or instance - FIRST_PLACEMENT[self.open_rack] not in self.placements()
        ):
            return "A dish goes only into a placement of its category in the rack that is out."
        if self._blocked[self.open_rack][instance - FIRST_PLACEMENT[self.open_rack]]:
            return "The placement is blocked by a dish in the rack."
        return ""

    def _carry_out(self, instance: int) -> None:
        if self.held is None and instance >= FIRST_DISH:
            self.held = instance - FIRST_DISH
            return
        if self.held is not None:
            self._put(instance)
        elif instance == DOOR:
            self.door_open = not self.door_open
        else:
            self.open_rack = RACK_OF_INSTANCE[instance] if self.open_rack is None else None
        self._complete_action()

    def _put(self, instance: int) -> None:
        if instance == SINK:
            self.location[self.held] = Location.SINK
            self.pose[self.held] = SINK_POSE
        else:
            self._put_into_rack(instance)
        self.held = None

    def _put_into_rack(self, instance: int) -> None:
        assert self.open_rack is not None
        rack, placement = self.open_rack, instance - FIRST_PLACEMENT[self.open_rack]
        self.location[self.held] = IN_RACK[rack]
        self.placement[self.held] = placement
        self.pose[self.held] = self.table.pose[rack][placement]
        self._blocked[rack] |= self.table.blocks[placement]

    def _complete_action(self) -> None:
        self.completed += 1
        cleared = self.open_rack is None and not (self.location == Location.COUNTER).any()
        if cleared or self.completed >= ARRIVALS_AT_LATEST:
            self._arriving = True
        if self._arriving and not self.all_arrived:
            self.location[self._arrived] = Location.COUNTER
            self._arrived += 1

    # What scores and pictures need -----------------------------------------------------------

    def pose_in_world(self) -> np.ndarray:
        """The pose of each dish in the world, (n, 7) float32; closed racks are further back (m)."""
        pose = self.pose.copy()
        for rack in RACKS:
            if rack != self.open_rack:
                pose[self.location == IN_RACK[rack], 1] += layout.RACK_TRAVEL
        return pose

    def digest(self) -> str:
        """A hash of the whole state, the same in every process."""
        joints = (self.door_open, self.open_rack, self.held)
        arrivals = (self.completed, self._arriving, self._arrived)
        sha = hashlib.sha256(repr(joints + arrivals).encode())
        for array in (*self.dishes.digested(), self.pose, self.location, self.placement):
            sha.update(np.ascontiguousarray(array).tobytes())
        return sha.hexdigest()


SINK_POSE = np.array([*layout.SINK_POSITION, 1, 0, 0, 0], dtype=np.float32)  # (7,)


def decision_kind(instance: int, dishes: Dishes) -> str:
    """What an instance is, with like dishes and like placements taken together.

    Returns:
        "door", "bottom rack", "top rack", a category, "in bottom", "in top" or "in sink".
    """
    if instance == SINK:
        return "in sink"
    if instance >= FIRST_PLACEMENT["top"]:
        return "in top"
    if instance >= FIRST_PLACEMENT["bottom"]:
        return "in bottom"
    if instance >= FIRST_DISH:
        return CATEGORIES[dishes.category[instance - FIRST_DISH]]
    return ("door", "bottom rack", "top rack")[instance]

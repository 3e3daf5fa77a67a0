"""The expert of the second tier: loads as a user does, and from any reachable state it finishes.

A dish's target is the first zone of its list that has a free placement. With a rack out, the expert
takes the waiting dishes that target it, the lowest rank first and of one rank the dish nearest to
the sink, and places each by style. When none is left it changes racks, as often as it
takes; then it drops the rest into the sink.
"""

from functools import cache

import numpy as np

from kitchen_prefs.people.attributes import FAMILY_OF
from kitchen_prefs.people.users import LoadingPlan
from kitchen_prefs.people.zones import (
    IS_IN_RACK,
    LEFT,
    OVERFLOW_INDEX,
    SINK_ZONE,
    targets_now,
    zone_of_placements,
)
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.expert import ExpertTrajectory, nearness_to_sink
from kitchen_prefs.simulation.kitchen import (
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    IN_RACK,
    RACK_INSTANCE,
    SINK,
    Kitchen,
    Location,
    PlacementTable,
    decision_kind,
    rack_position,
)

CORNERS = {"far left corner": (-1, 1), "near right corner": (1, -1)}  # signs of x and y
FALLBACK = {"beside its family": "far left corner", "apart from its family": "near right corner"}


class PlanExpert:
    """Loads a kitchen by a plan, which knows all of its dishes.

    Args:
        kitchen: The kitchen, which it reads and never changes.
        plan: How its dishes are loaded.
    """

    def __init__(self, kitchen: Kitchen, plan: LoadingPlan) -> None:
        self.kitchen = kitchen
        self.plan = plan
        nearness = [nearness_to_sink(pose) for pose in kitchen.dishes.pose]
        self._nearness = np.argsort(np.argsort([distance for distance, *_ in nearness]))  # (n,)

    def choose(self) -> int:
        """The next decision; the kitchen must not be finished."""
        kitchen = self.kitchen
        if kitchen.held is not None:
            return self.where_to_put()
        waiting = kitchen.counter
        targets = self.targets(waiting)
        if kitchen.open_rack is not None:
            mine = waiting[IS_IN_RACK[kitchen.open_rack][targets]]
            return self._next(mine) if len(mine) else RACK_INSTANCE[kitchen.open_rack]
        for rack in self.plan.racks:
            if IS_IN_RACK[rack][targets].any():
                return RACK_INSTANCE[rack] if kitchen.door_open else DOOR
        return self._next(waiting) if len(waiting) else DOOR

    def targets(self, dishes: np.ndarray) -> np.ndarray:
        """Where dishes would go now, (k,) int: a zone, or SINK_ZONE."""
        category = self.kitchen.dishes.category[dishes]
        targets = targets_now(self.kitchen)[OVERFLOW_INDEX[self.plan.overflow]]  # (7, 5)
        return targets[category, self.plan.zones[dishes]]

    def in_turn(self) -> frozenset[int] | None:
        """The dishes of the lowest rank that could be taken for the rack that is out.

        None if no rack is out, a dish is in hand, or the dishes that could be taken are of one
        rank, as all are of a user without an order.
        """
        kitchen = self.kitchen
        if kitchen.open_rack is None or kitchen.held is not None:
            return None
        waiting = kitchen.counter
        mine = waiting[IS_IN_RACK[kitchen.open_rack][self.targets(waiting)]]
        ranks = self.plan.ranks[mine]
        if len(set(ranks.tolist())) < 2:
            return None
        return frozenset(mine[ranks == ranks.min()].tolist())

    def where_to_put(self) -> int:
        """The place for the dish in hand: by style, or the sink."""
        kitchen, dish = self.kitchen, self.kitchen.held
        assert dish is not None
        target = int(self.targets(np.array([dish]))[0])
        rack = kitchen.open_rack
        if rack is None or not IS_IN_RACK[rack][target]:
            return SINK
        free = kitchen.free(rack, int(kitchen.dishes.category[dish]))
        free = free[zone_of_placements(kitchen.table)[rack][free] == target]
        return FIRST_PLACEMENT[rack] + place_by_style(kitchen, self.plan.style, free, rack, dish)

    def _next(self, dishes: np.ndarray) -> int:
        """The dish of the lowest rank, of one rank the nearest to the sink."""
        order = np.lexsort((self._nearness[dishes], self.plan.ranks[dishes]))
        return FIRST_DISH + int(dishes[order[0]])


def place_by_style(kitchen: Kitchen, style: str, free: np.ndarray, rack: str, dish: int) -> int:
    """The placement of some in a rack that a style prefers for a dish."""
    relatives = _relatives(kitchen, rack, dish)
    if style in FALLBACK and len(relatives) == 0:
        style = FALLBACK[style]
    if style in CORNERS:
        nearness = corner_distances(kitchen.table, rack, style)[free]
    else:
        poses = kitchen.table.pose[rack]
        apart = poses[free, None, :2] - poses[None, relatives, :2]  # (f, k, 2)
        nearness = np.hypot(*np.moveaxis(apart, -1, 0)).min(axis=1)
        nearness = -nearness if style == "apart from its family" else nearness
    return int(free[np.argmin(nearness)])


def _relatives(kitchen: Kitchen, rack: str, dish: int) -> np.ndarray:
    """The placements in a rack that dishes of a dish's family take."""
    family = FAMILY_OF[kitchen.dishes.category]
    own = (kitchen.location == IN_RACK[rack]) & (family == family[dish])
    return kitchen.placement[own]


@cache
def corner_distances(table: PlacementTable, rack: str, corner: str) -> np.ndarray:
    """How far each placement is from a corner of the rack that is out, seen from above, (P,) m."""
    x, y, _ = rack_position(rack, out=True)
    sign_x, sign_y = CORNERS[corner]
    place = (x + sign_x * layout.RACK_INNER[0] / 2, y + sign_y * layout.RACK_INNER[1] / 2)
    return np.hypot(*(table.pose[rack][:, :2] - place).T)


def ends_of(kitchen: Kitchen) -> np.ndarray:
    """The zone in which each dish is, SINK_ZONE for the sink, LEFT for one not put away, (n,)."""
    zones = np.full(len(kitchen.location), LEFT)
    zones[kitchen.location == Location.SINK] = SINK_ZONE
    for rack, zone in zone_of_placements(kitchen.table).items():
        own = kitchen.location == IN_RACK[rack]
        zones[own] = zone[kitchen.placement[own]]
    return zones


def roll_out_plan(kitchen: Kitchen, plan: LoadingPlan) -> ExpertTrajectory:
    """Let the expert finish a kitchen, which it changes.

    Args:
        kitchen: Any reachable state.
        plan: How its dishes are loaded.

    Returns:
        Its decisions and the finished kitchen.
    """
    expert = PlanExpert(kitchen, plan)
    decisions: list[int] = []
    while not kitchen.finished:
        decisions.append(expert.choose())
        refusal = kitchen.decide(decisions[-1])
        assert not refusal, f"The expert chose what the kitchen refuses: {refusal}"
    kinds = tuple(decision_kind(instance, kitchen.dishes) for instance in decisions)
    return ExpertTrajectory(tuple(decisions), kinds, kitchen)

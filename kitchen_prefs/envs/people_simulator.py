"""One session of the second tier simulated decision by decision, with the facts of its metrics."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from kitchen_prefs.envs.people_observations import DescribedObserver
from kitchen_prefs.envs.simulator import Simulator
from kitchen_prefs.metrics.people_episode import PeopleEpisode
from kitchen_prefs.people.attributes import DescribedDishes
from kitchen_prefs.people.expert import PlanExpert, ends_of
from kitchen_prefs.people.sessions import PeopleSession, people_table
from kitchen_prefs.people.splits import get_people_split
from kitchen_prefs.people.zones import SINK_ZONE, zone_of_place
from kitchen_prefs.simulation.kitchen import FIRST_DISH, IN_RACK, SINK, Kitchen


@dataclass(frozen=True)
class _Before:
    """What is known before a decision: the dishes whose turn it is, and the place by style."""

    turn: frozenset[int] | None
    styled: int | None


class PeopleSimulator(Simulator):
    """A session of the second tier from its start to where it is now.

    Args:
        session: What is simulated.

    Attributes:
        session: What is simulated.
        expert: Loads the kitchen as the user would, from where it is.
    """

    def __init__(self, session: PeopleSession) -> None:
        kitchen = Kitchen(session.dishes, people_table())
        observer = DescribedObserver(kitchen, session.generator("order"))
        super().__init__(kitchen, observer, len(session.expert.trajectory.decisions))
        self.session = session
        self.expert = PlanExpert(kitchen, session.expert.plan)
        self._right_turns = self._turns = 0
        self._right_style = self._styled = 0

    def expert_instance(self) -> int:
        """The instance that the expert would choose now."""
        return self.expert.choose()

    def is_right(self, instance: int) -> bool:
        """Whether a decision is a pick of the rank whose turn it is, or a place in its zone."""
        kitchen = self.kitchen
        if kitchen.held is not None:
            place = self.expert.where_to_put()
            if kitchen.refusal(instance):
                return False
            return zone_of_place(kitchen, instance) == zone_of_place(kitchen, place)
        wanted = self.expert.choose()
        if instance < FIRST_DISH or wanted < FIRST_DISH or kitchen.refusal(instance):
            return False
        dishes = np.array([instance, wanted]) - FIRST_DISH
        own, right = self.expert.targets(dishes)
        ranks = self.session.expert.plan.ranks[dishes]
        in_one_rack = own // 2 == right // 2  # zones come in pairs, and the sink after them
        return bool(in_one_rack and ranks[0] == ranks[1])

    def episode(self) -> PeopleEpisode:
        """The facts of the episode so far, from which every metric is computed."""
        session, kitchen = self.session, self.kitchen
        mine, theirs = ends(kitchen), ends(session.expert.trajectory.kitchen)
        by_hand = session.expert.plan.zones == SINK_ZONE
        in_rack = np.isin(kitchen.location, list(IN_RACK.values()))
        turns = session.expert_turns
        return PeopleEpisode(
            split=session.split,
            session=session.index,
            salt=session.salt,
            preference=get_people_split(session.split).user(session.index),
            dishes=len(kitchen.location),
            alike=(mine & theirs).total(),
            turns=(self._right_turns, max(self._turns, turns) if turns else 0),
            styled=(self._right_style, self._styled),
            by_hand_loaded=int((by_hand & in_rack).sum()),
            decisions=tuple(self.decisions),
            refused=tuple(self.refused),
            expert_decisions=len(session.expert.trajectory.decisions),
            closed=kitchen.closed,
            finished=kitchen.finished,
            actions=tuple(self.actions),
        )

    def _before(self, instance: int) -> _Before:
        if self.kitchen.held is None:
            return _Before(self.expert.in_turn(), None)
        place = self.expert.where_to_put()
        return _Before(None, None if place == SINK else place)

    def _count(self, instance: int, before: _Before) -> None:
        if before.turn is not None:
            self._turns += 1
            self._right_turns += instance - FIRST_DISH in before.turn
        if before.styled is not None:
            in_its_zone = zone_of_place(self.kitchen, instance) == zone_of_place(
                self.kitchen, before.styled
            )
            self._styled += in_its_zone
            self._right_style += instance == before.styled


def ends(kitchen: Kitchen) -> Counter[tuple]:
    """How many dishes of each kind are in each zone, in the sink, or left.

    Dishes are of a kind if no rule of any user tells them apart.
    """
    dishes = kitchen.dishes
    assert isinstance(dishes, DescribedDishes)
    kinds = (dishes.category, dishes.material, dishes.colour, dishes.greasy, dishes.classes("size"))
    attributes = (*kinds, ends_of(kitchen))
    return Counter(zip(*(values.tolist() for values in attributes), strict=True))

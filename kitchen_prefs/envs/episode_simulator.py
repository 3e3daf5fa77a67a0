"""One session simulated decision by decision: observations, decisions and the episode's facts.

The gymnasium environment and the leaderboard's replay both use it.
"""

from kitchen_prefs.envs.observations import Observer
from kitchen_prefs.envs.simulator import Simulator
from kitchen_prefs.metrics import Episode
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation import kitchen as k
from kitchen_prefs.simulation.expert import KitchenView, choose
from kitchen_prefs.simulation.kitchen import Kitchen, Location, decision_kind
from kitchen_prefs.simulation.sessions import Session, expert_trajectory
from kitchen_prefs.splits import get_split

FAILED_PICKS = 0.05  # one pick in twenty fails where grasping is noisy (design of `noisy`)


class EpisodeSimulator(Simulator):
    """A session of the first tier from its start to where it is now.

    Args:
        session: What is simulated.

    Attributes:
        session: What is simulated.
        view: The kitchen as the expert sees it.
    """

    def __init__(self, session: Session) -> None:
        noisy = get_split(session.split).noisy
        kitchen = Kitchen(session.dishes)
        noise = session.generator("noise") if noisy else None
        observer = Observer(kitchen, session.generator("order"), noise)
        super().__init__(kitchen, observer, len(expert_trajectory(session).decisions))
        self.session = session
        self.view = KitchenView(kitchen)
        self._closed_early = 0
        self._right_turns = self._turns = 0
        self._grasp = session.generator("grasp") if noisy else None

    def expert_instance(self) -> int:
        """The instance that the expert would choose now."""
        return choose(self.view, self.session.preference)

    def episode(self) -> Episode:
        """The facts of the episode so far, from which every metric is computed."""
        session, kitchen = self.session, self.kitchen
        expert = expert_trajectory(session)
        placed, wrong_rack = _standing(kitchen, session)
        return Episode(
            split=session.split,
            session=session.index,
            salt=session.salt,
            preference=session.label,
            count=session.count,
            decisions=tuple(self.decisions),
            kinds=tuple(decision_kind(instance, session.dishes) for instance in self.decisions),
            expert_decisions=expert.decisions,
            expert_kinds=expert.kinds,
            placed=placed,
            expert_placed=_standing(expert.kitchen, session)[0],
            wrong_rack=wrong_rack,
            sunk=int((kitchen.location == Location.SINK).sum()),
            expert_sunk=int((expert.kitchen.location == Location.SINK).sum()),
            refused=tuple(self.refused),
            blocked_places=sum(
                was_refused and instance >= k.SINK
                for was_refused, instance in zip(self.refused, self.decisions, strict=True)
            ),
            longest_loop=_longest_loop(self.decisions, self.refused),
            turns=(self._right_turns, self._turns),
            closed_early=self._closed_early,
            closed=kitchen.closed,
            finished=kitchen.finished,
            actions=tuple(self.actions),
        )

    def _before(self, instance: int) -> tuple[bool, list[int] | None]:
        """Whether the decision closes the door early, and the dishes whose turn it is."""
        return instance == k.DOOR and self.door_closes_early(), self._dishes_in_turn()

    def _count(self, instance: int, before: tuple[bool, list[int] | None]) -> None:
        early, turn = before
        self._closed_early += early
        if turn is not None:
            self._turns += 1
            self._right_turns += instance - k.FIRST_DISH in turn

    def _carry_out(self, instance: int) -> str:
        fails = self._grasp is not None and self._grasp.random() < FAILED_PICKS
        if fails and instance >= k.FIRST_DISH and self.kitchen.held is None:
            return "The grasp failed."
        return super()._carry_out(instance)

    def _dishes_in_turn(self) -> list[int] | None:
        """The dishes of the lowest rank that wait for the rack that is out.

        None if a dish is in hand, no rack is out, or the dishes of fewer than two ranks wait.
        """
        if self.kitchen.held is not None or self.kitchen.open_rack is None:
            return None
        preference, category = self.session.preference, self.session.dishes.category
        names = {dish: CATEGORIES[category[dish]] for dish in self.kitchen.counter.tolist()}
        ranks = {
            dish: preference.rank_of[name]
            for dish, name in names.items()
            if preference.rack_of[name] == self.kitchen.open_rack
        }
        if len(set(ranks.values())) < 2:
            return None
        return [dish for dish, rank in ranks.items() if rank == min(ranks.values())]


def _standing(kitchen: Kitchen, session: Session) -> tuple[tuple[int, int], int]:
    """The dishes that stand in their preferred rack, (top, bottom), and those in the other rack."""
    standing = {"top": 0, "bottom": 0}
    wrong = 0
    for rack in RACKS:
        for category in kitchen.dishes.category[kitchen.location == k.IN_RACK[rack]]:
            right = session.preference.rack_of[CATEGORIES[category]] == rack
            standing[rack] += right
            wrong += not right
    return (standing["top"], standing["bottom"]), wrong


def _longest_loop(decisions: list[int], refused: list[bool]) -> int:
    """The most times in a row that one refused decision was repeated."""
    longest = run = 0
    previous = None
    for instance, was_refused in zip(decisions, refused, strict=True):
        run = (run + 1 if instance == previous else 1) if was_refused else 0
        previous = instance if was_refused else None
        longest = max(longest, run)
    return longest

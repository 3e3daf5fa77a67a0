"""One session simulated decision by decision: observations, decisions and the episode's facts.

The gymnasium environment and the leaderboard's replay both use it.
"""

import hashlib
from collections.abc import Sequence

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.actions import nearest_row
from kitchen_prefs.envs.observations import Observer
from kitchen_prefs.metrics import Episode
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation import kitchen as k
from kitchen_prefs.simulation.expert import KitchenView, choose
from kitchen_prefs.simulation.kitchen import Kitchen, Location, decision_kind
from kitchen_prefs.simulation.sessions import Session, expert_trajectory
from kitchen_prefs.splits import get_split

Action = np.ndarray | Sequence[float]  # a pose: position (m) and quaternion (wxyz), (7,)

LIMIT_FACTOR = 2  # an episode ends at twice the expert's number of decisions
FAILED_PICKS = 0.05  # one pick in twenty fails where grasping is noisy (design of `noisy`)


class EpisodeSimulator:
    """A session from its start to where it is now.

    Args:
        session: What is simulated.

    Attributes:
        session: What is simulated.
        kitchen: Its kitchen.
        view: The kitchen as the expert sees it.
        observer: Makes the observations.
        observation: The observation of the next decision.
        decisions: The instances chosen so far.
        refused: For each of them, whether it could not be carried out.
        limit: The number of decisions at which the episode is truncated.
    """

    def __init__(self, session: Session) -> None:
        noisy = get_split(session.split).noisy
        self.session = session
        self.kitchen = Kitchen(session.dishes)
        self.view = KitchenView(self.kitchen)
        self.decisions: list[int] = []
        self.refused: list[bool] = []
        self.limit = LIMIT_FACTOR * len(expert_trajectory(session).decisions)
        self._actions: list[tuple[float, ...]] = []
        self._closed_early = 0
        self._right_turns = self._turns = 0
        self._grasp = session.generator("grasp") if noisy else None
        noise = session.generator("noise") if noisy else None
        self.observer = Observer(self.kitchen, session.generator("order"), noise)
        self.observation = self.observer.observe()

    @property
    def terminated(self) -> bool:
        """Whether everything is packed and closed."""
        return self.kitchen.finished

    @property
    def truncated(self) -> bool:
        """Whether the limit of decisions is reached before that."""
        return not self.terminated and len(self.decisions) >= self.limit

    def choose(self, action: Action) -> tuple[int, float]:
        """The instance that an action chooses now, and how far away it is.

        Raises:
            ValueError: If the action has another shape or is not finite.
        """
        row, distance = nearest_row(self.observation.rows, action)
        return int(self.observation.ids[row]), distance

    def act(self, action: Action) -> str:
        """Carry out the decision that an action chooses; see `choose` and `decide`."""
        return self.decide(self.choose(action)[0], action)

    def decide(self, instance: int, action: Action) -> str:
        """Carry out one decision and observe again.

        Args:
            instance: What the action chooses.
            action: The action, which is recorded.

        Returns:
            Why the kitchen did not carry it out, or an empty string.
        """
        early = instance == k.DOOR and self._door_closes_early()
        turn = self._dishes_in_turn()
        refusal = self._carry_out(instance)
        self.decisions.append(instance)
        self.refused.append(bool(refusal))
        self._actions.append(tuple(float(value) for value in action))
        self._closed_early += early and not refusal
        if turn is not None and not refusal:
            self._turns += 1
            self._right_turns += instance - k.FIRST_DISH in turn
        self.observation = self.observer.observe()
        return refusal

    def expert_action(self) -> np.ndarray:
        """The action with which the expert would continue from here, (7,)."""
        row = self.observation.row_of(choose(self.view, self.session.preference))
        return self.observation.rows[row, instances.POSE]

    def feasible_rows(self) -> np.ndarray:
        """The rows that the kitchen would carry out now, zero-padded, (N,) bool.

        An oracle, which no track shows: it knows, for one, which placements are blocked.
        """
        feasible = np.zeros(instances.CAPACITY, dtype=bool)
        for row in np.flatnonzero(instances.choosable(self.observation.rows)):
            feasible[row] = not self.kitchen.refusal(int(self.observation.ids[row]))
        return feasible

    def digest(self) -> str:
        """A hash of the kitchen's state and of all that was decided, the same in every process."""
        sha = hashlib.sha256(self.kitchen.digest().encode())
        sha.update(repr((self.decisions, self.refused)).encode())
        return sha.hexdigest()

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
            actions=tuple(self._actions),
        )

    def _carry_out(self, instance: int) -> str:
        fails = self._grasp is not None and self._grasp.random() < FAILED_PICKS
        if fails and instance >= k.FIRST_DISH and self.kitchen.held is None:
            return "The grasp failed."
        return self.kitchen.decide(instance)

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

    def _door_closes_early(self) -> bool:
        waiting = len(self.kitchen.counter) > 0 or not self.kitchen.all_arrived
        return self.kitchen.door_open and waiting


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

"""A session simulated decision by decision, whatever its tier; a tier adds its expert and facts."""

import hashlib
from collections.abc import Sequence
from typing import Any

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.envs.actions import nearest_row
from kitchen_prefs.envs.observations import Observer
from kitchen_prefs.simulation.kitchen import Kitchen

Action = np.ndarray | Sequence[float]  # a pose: position (m) and quaternion (wxyz), (7,)

LIMIT_FACTOR = 2  # an episode ends at twice the expert's number of decisions


class Simulator:
    """A kitchen from its start to where it is now.

    Args:
        kitchen: The kitchen.
        observer: Makes the observations.
        expert_decisions: How many decisions the expert takes from the start.

    Attributes:
        kitchen: The kitchen.
        observer: Makes the observations.
        observation: The observation of the next decision.
        decisions: The instances chosen so far.
        refused: For each of them, whether it could not be carried out.
        actions: For each of them, the action that was given.
        limit: The number of decisions at which the episode is truncated.
    """

    def __init__(self, kitchen: Kitchen, observer: Observer, expert_decisions: int) -> None:
        self.kitchen = kitchen
        self.observer = observer
        self.observation = observer.observe()
        self.decisions: list[int] = []
        self.refused: list[bool] = []
        self.actions: list[tuple[float, ...]] = []
        self.limit = LIMIT_FACTOR * expert_decisions

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
        before = self._before(instance)
        refusal = self._carry_out(instance)
        self.decisions.append(instance)
        self.refused.append(bool(refusal))
        self.actions.append(tuple(float(value) for value in action))
        if not refusal:
            self._count(instance, before)
        self.observation = self.observer.observe()
        return refusal

    def expert_instance(self) -> int:
        """The instance that the expert would choose now."""
        raise NotImplementedError

    def episode(self) -> Any:
        """The facts of the episode so far, from which the tier's metrics are computed."""
        raise NotImplementedError

    def expert_action(self) -> np.ndarray:
        """The action with which the expert would continue from here, (7,)."""
        row = self.observation.row_of(self.expert_instance())
        return self.observation.rows[row, instances.POSE]

    def feasible_rows(self) -> np.ndarray:
        """The rows that the kitchen would carry out now, zero-padded, (N,) bool.

        An oracle, which no track shows: it knows, for one, which placements are blocked.
        """
        rows = self.observation.rows
        feasible = np.zeros(instances.CAPACITIES[rows.shape[1]], dtype=bool)
        for row in np.flatnonzero(instances.choosable(rows)):
            feasible[row] = not self.kitchen.refusal(int(self.observation.ids[row]))
        return feasible

    def digest(self) -> str:
        """A hash of the kitchen's state and of all that was decided, the same in every process."""
        sha = hashlib.sha256(self.kitchen.digest().encode())
        sha.update(repr((self.decisions, self.refused)).encode())
        return sha.hexdigest()

    def door_closes_early(self) -> bool:
        """Whether the open door, if it were closed now, would shut out dishes."""
        waiting = len(self.kitchen.counter) > 0 or not self.kitchen.all_arrived
        return self.kitchen.door_open and waiting

    def _before(self, instance: int) -> Any:
        """What a tier has to know of the state in which a decision is taken."""
        raise NotImplementedError

    def _count(self, instance: int, before: Any) -> None:
        """Count what a decision that was carried out means for the tier's metrics."""
        raise NotImplementedError

    def _carry_out(self, instance: int) -> str:
        return self.kitchen.decide(instance)

"""One session of the drawers, simulated decision by decision, seen through imperfect perception."""

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, Toggle, is_finished, refusal
from kitchen_prefs_robot.task.rows import placed
from kitchen_prefs_robot.task.sessions import DrawersSession
from kitchen_prefs_robot.task.state import DrawersState, SeenDish

LIMIT_FACTOR = 2  # an episode ends at twice the expert's number of decisions, as in the kitchen


@dataclass(frozen=True)
class Perception:
    """How far the seen state is from the true one.

    Attributes:
        noise: Standard deviation of each coordinate of a dish on the table, m; drawn at each look.
        misread: The share of dishes that are taken for another category of the session, from the
            first look to the last.
    """

    noise: float = 0.0
    misread: float = 0.0


PERFECT = Perception()


class DrawersSimulator:
    """A session from its start to where it is now.

    Args:
        session: What is simulated.
        perception: How it is seen.

    Attributes:
        session: What is simulated.
        seen: The state as it is seen before the next decision.
        decisions: The decisions so far; a dish has its number at the session's start.
        refused: For each of them, whether it could not be carried out.
        limit: The number of decisions at which the episode is truncated.
    """

    def __init__(self, session: DrawersSession, perception: Perception = PERFECT) -> None:
        self.session = session
        self.decisions: list[Decision] = []
        self.refused: list[bool] = []
        self.limit = LIMIT_FACTOR * _expert_length(session)
        self.opened: str | None = None
        self.held: int | None = None
        self.dishes = list(session.start.dishes)
        self._noise = perception.noise
        self._generator = session.generator("perception")
        self._read = _misread(session, perception.misread, self._generator)
        self.seen = self._look()

    @property
    def state(self) -> DrawersState:
        """The true state."""
        return self._state(self.dishes, [dish.category for dish in self.dishes])

    @property
    def terminated(self) -> bool:
        """Whether all dishes are in drawers and both are closed."""
        return is_finished(self.state)

    @property
    def truncated(self) -> bool:
        """Whether the limit of decisions is reached before that."""
        return not self.terminated and len(self.decisions) >= self.limit

    def decide(self, decision: Decision) -> str:
        """Carry out one decision and look again.

        Args:
            decision: One of `decisions.choices(seen)`.

        Returns:
            Why it could not be carried out, or an empty string.
        """
        refused = refusal(self.state, decision)
        if isinstance(decision, Pick):
            decision = Pick(self._on_view()[decision.dish])
        self.decisions.append(decision)
        self.refused.append(bool(refused))
        if not refused:
            self._carry_out(decision)
        self.seen = self._look()
        return refused

    def _carry_out(self, decision: Decision) -> None:
        if isinstance(decision, Toggle):
            self.opened = None if self.opened else decision.drawer
        elif isinstance(decision, Pick):
            self.held = decision.dish
        else:
            assert isinstance(decision, Place)
            assert self.held is not None
            self.dishes[self.held] = placed(self.dishes[self.held].category, decision.drawer)
            self.held = None

    def _on_view(self) -> list[int]:
        """The numbers of all dishes but the one in hand."""
        return [i for i in range(len(self.dishes)) if i != self.held]

    def _look(self) -> DrawersState:
        errors = self._noise * self._generator.standard_normal((len(self.dishes), 3))  # (n, 3) m
        return self._state(
            [_moved(dish, error) for dish, error in zip(self.dishes, errors, strict=True)],
            self._read,
        )

    def _state(self, dishes: Iterable[SeenDish], categories: Iterable[str]) -> DrawersState:
        named = [replace(d, category=c) for d, c in zip(dishes, categories, strict=True)]
        in_hand = None if self.held is None else named[self.held].category
        return DrawersState(tuple(named[i] for i in self._on_view()), self.opened, in_hand)


def _moved(dish: SeenDish, error: np.ndarray) -> SeenDish:
    """A dish on the table as a noisy look sees it; those in drawers have the drop pose."""
    if dish.drawer is not None:
        return dish
    x, y, z = (np.array(dish.position) + error).tolist()
    return replace(dish, position=(x, y, z))


def _misread(session: DrawersSession, share: float, generator: np.random.Generator) -> list[str]:
    """The category that each dish is taken for."""
    read = []
    for dish in session.start.dishes:
        others = [c for c in session.preference.categories if c != dish.category]
        wrong = generator.random() < share
        read.append(str(generator.choice(others)) if wrong else dish.category)
    return read


def _expert_length(session: DrawersSession) -> int:
    """How often the expert decides: pick and place of each dish, open and close of each drawer."""
    dishes = session.start.dishes
    drawers = {session.preference.drawer_of[dish.category] for dish in dishes}
    return 2 * len(dishes) + 2 * len(drawers)

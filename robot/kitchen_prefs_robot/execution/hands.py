"""What carries out decisions: the arm under contact physics, or an invisible hand."""

from typing import Protocol

import numpy as np

from kitchen_prefs_robot.demonstrations.person import (
    put_into_drawer,
    slide_drawer,
    take_in_hand,
)
from kitchen_prefs_robot.execution.looking import Look, TableDish
from kitchen_prefs_robot.execution.whereabouts import drawer_of, highest, nearest_on_table
from kitchen_prefs_robot.motion.drawers import close_drawer, open_drawer
from kitchen_prefs_robot.motion.dropping import drop
from kitchen_prefs_robot.motion.moves import OnFrame
from kitchen_prefs_robot.motion.outcomes import Result
from kitchen_prefs_robot.motion.picking import PickOutcome, pick, put_back
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.layout import DRAWER_TRAVEL

# m to the side of a dish, where a pick that is led astray takes its points to be: half of that, and
# it would grasp a bowl by its other wall.
ASTRAY = 0.09


class Hand(Protocol):
    """Carries out decisions in a world, each to its end."""

    held: int | None  # the number of the dish that it truly holds

    def move_drawer(self, drawer: str, look: Look) -> Result:
        """Open a drawer that was seen closed, or close it."""

    def pick(self, dish: TableDish, look: Look) -> Result:
        """Pick a dish where it was seen."""

    def drop(self, drawer: str, already: int, look: Look) -> Result:
        """Drop what is held into an open drawer that holds some dishes already."""


class ArmHand:
    """The arm: whatever it touches, moves.

    Args:
        world: In which it acts.
        grasp_failures: The share of picks that are led astray.
        seed: Draws which.
        on_frame: Called with the world 50 times a simulated second.
    """

    def __init__(
        self, world: World, grasp_failures: float, seed: int, on_frame: OnFrame | None = None
    ) -> None:
        self.held: int | None = None
        self._world, self._on_frame = world, on_frame
        self._grasp_failures = grasp_failures
        self._rng = np.random.default_rng([seed, len("astray")])
        self._picked: PickOutcome | None = None

    def move_drawer(self, drawer: str, look: Look) -> Result:
        """Pull a drawer open by its handle, which is where it was seen, or push it shut."""
        move = close_drawer if look.opened == drawer else open_drawer
        return move(self._world, drawer, look.furniture, self._on_frame).result

    def pick(self, dish: TableDish, look: Look) -> Result:
        """Grasp a dish and lift it."""
        points = dish.points + self._error()
        others, known = dish.others(), look.furniture
        self._picked = pick(self._world, points, others, known, self._on_frame)
        self.held = highest(self._world) if self._picked.succeeded else None
        return self._picked.result

    def drop(self, drawer: str, already: int, look: Look) -> Result:
        """Carry what is held over the open drawer and let go, or put it back if that cannot be."""
        assert self._picked is not None
        known = look.furniture
        outcome = drop(self._world, drawer, self._picked, already, known, self._on_frame)
        if outcome.result in (Result.UNREACHABLE, Result.NOT_OPEN):
            put_back(self._world, self._picked, self._on_frame)
        self.held = None
        return outcome.result

    def _error(self) -> np.ndarray:
        """By how much a pick is led astray, (3,) m."""
        if self._rng.random() >= self._grasp_failures:
            return np.zeros(3)
        angle = self._rng.uniform(-np.pi, np.pi)
        return ASTRAY * np.array([np.cos(angle), np.sin(angle), 0.0])


class InvisibleHand:
    """Moves dishes and drawers as a person does, and misses only what is not there.

    Args:
        world: In which it acts.
    """

    def __init__(self, world: World) -> None:
        self.held: int | None = None
        self._world = world

    def move_drawer(self, drawer: str, look: Look) -> Result:
        """Move a drawer together with the dishes in it."""
        inside = [
            n for n in range(len(self._world.scene.dishes)) if drawer_of(self._world, n) == drawer
        ]
        slide_drawer(self._world, drawer, 0.0 if look.opened == drawer else DRAWER_TRAVEL, inside)
        return Result.DONE

    def pick(self, dish: TableDish, look: Look) -> Result:
        """Take the dish that was seen, or miss it where none stands."""
        self.held = nearest_on_table(self._world, dish.middle)
        if self.held is None:
            return Result.MISSED
        take_in_hand(self._world, self.held)
        return Result.DONE

    def drop(self, drawer: str, already: int, look: Look) -> Result:
        """Drop what is held into its slot of the drawer."""
        assert self.held is not None
        put_into_drawer(self._world, self.held, drawer, already)
        self.held = None
        return Result.DONE

"""A person who loads the drawers by hand: dishes and drawers move without the arm."""

from collections.abc import Iterable

import numpy as np

from kitchen_prefs.simulation.layout import COUNTER_HEIGHT
from kitchen_prefs_robot.perception.regions import HAND
from kitchen_prefs_robot.real_to_sim import measure_counter
from kitchen_prefs_robot.scene import World
from kitchen_prefs_robot.scene.layout import (
    CABINET_ROTATION,
    DRAWER_FLOOR,
    DRAWER_TRAVEL,
    from_cabinet,
)
from kitchen_prefs_robot.scene.tableware import real_extents
from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, Toggle
from kitchen_prefs_robot.task.expert import choose
from kitchen_prefs_robot.task.preferences import DrawerPreference
from kitchen_prefs_robot.task.rows import UPRIGHT, placed
from kitchen_prefs_robot.task.state import DrawersState, SeenDish

# m from the cabinet's front and to its left where the next dish of an open drawer is put: front
# right, back left, front left, back right.
SLOTS = ((0.19, -0.09), (0.07, 0.09), (0.19, 0.09), (0.07, -0.09))
DROP_HEIGHT = 0.01  # m over the drawer's floor
SETTLING = 0.5  # s of simulated time until a dropped dish lies still


class Person:
    """Demonstrates a preference in a world.

    Args:
        world: In which dishes and drawers are moved.
        preference: What is demonstrated; it names the categories of all dishes.
    """

    def __init__(self, world: World, preference: DrawerPreference) -> None:
        self._world = world
        self._preference = preference
        self._counter = measure_counter(noise=0.0)
        self._opened: str | None = None
        self._held: int | None = None
        self._drawers: dict[int, str] = {}  # dish -> where it has been put

    @property
    def has_finished(self) -> bool:
        """Whether all dishes are in drawers and both are closed."""
        return len(self._drawers) == len(self._world.scene.dishes) and self._opened is None

    @property
    def holds(self) -> str | None:
        """The category of the dish in hand."""
        return None if self._held is None else self._world.scene.dishes[self._held].category

    def act(self) -> None:
        """Carry out the next decision of the preference's expert."""
        others = [n for n in range(len(self._world.scene.dishes)) if n != self._held]
        state = DrawersState(tuple(map(self._true, others)), self._opened, self.holds)
        self._carry_out(choose(state, self._preference), others)

    def _true(self, number: int) -> SeenDish:
        """A dish where it truly is."""
        category, drawer = self._world.scene.dishes[number].category, self._drawers.get(number)
        if drawer is not None:
            return placed(category, drawer)
        x, y = self._counter.to_kitchen(self._world.dish_pose(number)[0][:2])
        return SeenDish(category, (float(x), float(y), COUNTER_HEIGHT), UPRIGHT, None)

    def _carry_out(self, decision: Decision, others: list[int]) -> None:
        if isinstance(decision, Toggle):
            inside = [n for n, drawer in self._drawers.items() if drawer == decision.drawer]
            opening = 0.0 if self._opened else DRAWER_TRAVEL
            slide_drawer(self._world, decision.drawer, opening, inside)
            self._opened = None if self._opened else decision.drawer
        elif isinstance(decision, Pick):
            self._held = others[decision.dish]
            take_in_hand(self._world, self._held)
        else:
            assert isinstance(decision, Place)
            self._put(decision.drawer)

    def _put(self, drawer: str) -> None:
        """Put the dish in hand into the next slot of a drawer."""
        assert self._held is not None
        taken = sum(other == drawer for other in self._drawers.values())
        put_into_drawer(self._world, self._held, drawer, taken)
        self._drawers[self._held] = drawer
        self._held = None


def take_in_hand(world: World, number: int) -> None:
    """Hold a dish where the cameras see it in a person's hand."""
    world.set_dish_pose(number, np.array(HAND), world.dish_pose(number)[1])


def put_into_drawer(world: World, number: int, drawer: str, already: int) -> None:
    """Put a dish into the next slot of an open drawer, and let it come to rest.

    Args:
        world: In which it moves.
        number: The dish's number.
        drawer: "upper" or "lower".
        already: How many dishes lie in that drawer.
    """
    category = world.scene.dishes[number].category
    height = DRAWER_FLOOR[drawer] + real_extents(category)[2] / 2 + DROP_HEIGHT
    place = from_cabinet(np.array([*SLOTS[already % len(SLOTS)], height]))
    world.set_dish_pose(number, place, world.dish_pose(number)[1])
    world.advance(SETTLING)


def slide_drawer(world: World, drawer: str, opening: float, inside: Iterable[int]) -> None:
    """Open or close a drawer together with the dishes in it, without the arm.

    Args:
        world: In which they move.
        drawer: "upper" or "lower".
        opening: m by which it is open afterwards.
        inside: The numbers of the dishes in it.
    """
    shift = CABINET_ROTATION.apply((opening - world.drawer_opening(drawer), 0.0, 0.0))
    world.set_drawer(drawer, opening)
    for number in inside:
        position, quaternion = world.dish_pose(number)
        world.set_dish_pose(number, position + shift, quaternion)

"""One scene, loaded decision by decision: the robot looks, somebody decides, the robot executes."""

from types import TracebackType
from typing import Self

import numpy as np

from kitchen_prefs_robot.execution.conditions import REAL, Conditions
from kitchen_prefs_robot.execution.hands import ArmHand, Hand, InvisibleHand
from kitchen_prefs_robot.execution.looking import NOTHING_SEEN, TableDish, make_eyes
from kitchen_prefs_robot.execution.step import Step
from kitchen_prefs_robot.execution.whereabouts import nearest_on_table
from kitchen_prefs_robot.motion.moves import OnFrame
from kitchen_prefs_robot.motion.outcomes import Result
from kitchen_prefs_robot.perception.not_seen import NotSeenError
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.task.decisions import (
    Decision,
    Pick,
    Place,
    Toggle,
    is_finished,
    refusal,
)
from kitchen_prefs_robot.task.preferences import DrawerPreference
from kitchen_prefs_robot.task.rows import observe, placed
from kitchen_prefs_robot.task.simulator import LIMIT_FACTOR
from kitchen_prefs_robot.task.state import DrawersState, SeenDish


class RobotEpisode:
    """A scene from its start to where it is now; a context manager that releases the cameras.

    Args:
        scene: The seed of the scene.
        preference: It names the dishes, one of each category, and nothing more is read of it.
        conditions: What is left to the robot.
        on_frame: Called with the world 50 times a simulated second while the arm moves.

    Attributes:
        world: The scene under physics.
        preference: As given.
        look: The last look, without the dish in hand.
        steps: The decisions so far.
        limit: The number of decisions at which the episode is truncated: twice the expert's.
        blind: What the cameras do not see, in a sentence, which ends the episode; else empty.

    Raises:
        NoOpenGLError: If there is no OpenGL library to draw with.
    """

    def __init__(
        self,
        scene: int,
        preference: DrawerPreference,
        conditions: Conditions = REAL,
        on_frame: OnFrame | None = None,
    ) -> None:
        self.world = World(
            sample_scene(scene, preference.categories, conditions.colours, conditions.lamp)
        )
        self.preference = preference
        self.steps: list[Step] = []
        self.limit = LIMIT_FACTOR * (2 * len(preference.categories) + 4)
        self.look, self.blind = NOTHING_SEEN, ""
        self._hand = _hand(self.world, conditions, scene, on_frame)
        self._in_hand: str | None = None
        self._placed: list[SeenDish] = []
        self._eyes = make_eyes(self.world, conditions, scene)
        try:
            self._look()
        except BaseException:
            self._eyes.close()
            raise
        if not self.look.dishes and not self.blind:
            self.blind = f"The cameras see no dish in scene {scene}; clear the view."

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._eyes.close()

    @property
    def state(self) -> DrawersState:
        """What the robot knows: the dishes that it sees, and where it has put the others."""
        seen = (dish.seen for dish in self.look.dishes)
        return DrawersState((*seen, *self._placed), self.look.opened, self._in_hand)

    @property
    def rows(self) -> np.ndarray:
        """The instance set of the next decision, (N, 13)."""
        return observe(self.state, len(self.steps))

    @property
    def terminated(self) -> bool:
        """Whether the robot sees no dish, holds none, and both drawers are closed."""
        return not self.blind and is_finished(self.state)

    @property
    def truncated(self) -> bool:
        """Whether before that the limit of decisions is reached, or the robot does not see."""
        return bool(self.blind) or (not self.terminated and len(self.steps) >= self.limit)

    @property
    def held(self) -> int | None:
        """The true number of the dish in hand, for reports."""
        return self._hand.held

    def decide(self, decision: Decision) -> Step:
        """Execute a decision, and look again.

        While the hand holds a dish it hides the counter: then pictures are taken, but not read.

        Args:
            decision: One of `task.decisions.choices(state)`.

        Returns:
            The decision and what came of it.
        """
        state = self.state
        refused, about = refusal(state, decision), self._about(decision)
        result, dish = (None, None) if refused else self._execute(decision)
        step = Step(state, decision, refused, result, about, dish)
        self.steps.append(step)
        if not refused and self._in_hand is None:
            self._look()
        elif not refused:
            self.look = self.look.with_pictures(self._eyes.take())
        return step

    def _look(self) -> None:
        """Look anew, and note what cannot be done without and is not seen."""
        try:
            self.look = self._eyes.look()
        except NotSeenError as error:
            self.blind = str(error)

    def _about(self, decision: Decision) -> str | None:
        """The category that a decision's dish is taken for."""
        if isinstance(decision, Pick):
            return self.state.dishes[decision.dish].category
        return self._in_hand if isinstance(decision, Place) else None

    def _execute(self, decision: Decision) -> tuple[Result, int | None]:
        """Carry out a decision that the rules allow: how it ended, and the dish that was held."""
        if isinstance(decision, Toggle):
            return self._hand.move_drawer(decision.drawer, self.look), None
        if isinstance(decision, Pick):
            return self._pick(self.look.dishes[decision.dish])
        return self._drop(decision.drawer)

    def _pick(self, dish: TableDish) -> tuple[Result, int | None]:
        reached_for = nearest_on_table(self.world, dish.middle)  # for reports
        result = self._hand.pick(dish, self.look)
        if result is not Result.DONE:
            return result, reached_for
        self._in_hand = dish.seen.category
        self.look = self.look.without(dish)
        return result, self._hand.held

    def _drop(self, drawer: str) -> tuple[Result, int | None]:
        assert self._in_hand is not None
        held, already = self._hand.held, sum(dish.drawer == drawer for dish in self._placed)
        result = self._hand.drop(drawer, already, self.look)
        if result is Result.DONE:
            self._placed.append(placed(self._in_hand, drawer))
        self._in_hand = None
        return result, held


def _hand(world: World, conditions: Conditions, seed: int, on_frame: OnFrame | None) -> Hand:
    if conditions.grasps == "truth":
        return InvisibleHand(world)
    return ArmHand(world, conditions.grasp_failures, seed, on_frame)

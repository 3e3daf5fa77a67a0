"""The expert's demonstration of a session of the drawers."""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs_robot.task.decisions import Decision, choices
from kitchen_prefs_robot.task.expert import choose
from kitchen_prefs_robot.task.rows import observe, prompt_of
from kitchen_prefs_robot.task.sessions import DrawersSession
from kitchen_prefs_robot.task.simulator import PERFECT, DrawersSimulator, Perception
from kitchen_prefs_robot.task.state import DrawersState


@dataclass(frozen=True)
class DrawersDemonstration:
    """A demonstration, T decisions.

    Attributes:
        sets: The instance set of each decision, (N, 13) each.
        chosen: The row that each decision chose.
        decisions: The decisions; a dish has its number at the session's start.
        states: The state that was seen before each decision.
    """

    sets: tuple[np.ndarray, ...]
    chosen: tuple[int, ...]
    decisions: tuple[Decision, ...]
    states: tuple[DrawersState, ...]

    @property
    def prompt(self) -> np.ndarray:
        """The demonstration as a prompt, (1664, 14) float32."""
        return prompt_of(self.sets, self.chosen)


def demonstrate(session: DrawersSession, perception: Perception = PERFECT) -> DrawersDemonstration:
    """Let the expert, who knows the true state, show a session that is seen by a perception."""
    simulator = DrawersSimulator(session, perception)
    sets: list[np.ndarray] = []
    chosen: list[int] = []
    states: list[DrawersState] = []
    while not simulator.terminated:
        decision = choose(simulator.state, session.preference)
        states.append(simulator.seen)
        sets.append(observe(simulator.seen, len(sets)))
        chosen.append(choices(simulator.seen).index(decision))
        refused = simulator.decide(decision)
        assert not refused, f"The expert chose what is refused: {refused}"
    return DrawersDemonstration(
        tuple(sets), tuple(chosen), tuple(simulator.decisions), tuple(states)
    )

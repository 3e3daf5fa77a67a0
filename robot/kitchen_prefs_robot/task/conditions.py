"""The conditions under which a policy of the drawers is evaluated."""

from collections.abc import Iterator, Sequence

from kitchen_prefs.evaluation.rollouts import Policy
from kitchen_prefs.metrics import Episode
from kitchen_prefs_robot.task.rollouts import roll_out, roll_out_expert
from kitchen_prefs_robot.task.sessions import DrawersSession
from kitchen_prefs_robot.task.simulator import PERFECT, Perception

MISREAD = Perception(misread=0.1)
PERCEPTIONS = {
    "perfect poses": PERFECT,
    "8 mm of noise": Perception(noise=0.008),
    "15 mm of noise": Perception(noise=0.015),
    "10 % misread": MISREAD,
}


def evaluate(
    policy: Policy, sessions: Sequence[DrawersSession]
) -> Iterator[tuple[str, list[Episode]]]:
    """Roll a policy out under each condition, and what it compares with.

    Yields:
        The condition and its episodes. The expert that sees misread categories is the most that can
        be hoped for there; the opposite prompt shows each category in the other drawer, so a policy
        that reads its prompt gets nothing right.
    """
    for name, perception in PERCEPTIONS.items():
        yield name, roll_out(policy, sessions, perception, name=name)
    yield "10 % misread, expert", roll_out_expert(sessions, MISREAD)
    yield "opposite prompt", roll_out(policy, sessions, opposite=True, name="opposite prompt")

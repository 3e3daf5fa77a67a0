"""What a dish that is not right failed by: the last thing that was done with it says it.

perception      it was taken for another category, or not seen
demonstration   its category was misread in the demonstration, or no demonstration was understood
grasp           the hand missed it, lost it, or knocked it over
drawer          its drawer did not open
decision        the policy decided otherwise than the person
"""

from collections.abc import Iterable
from itertools import chain

from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.step import Step
from kitchen_prefs_robot.execution.whereabouts import drawer_of, is_on_table
from kitchen_prefs_robot.motion.outcomes import Result
from kitchen_prefs_robot.task.decisions import Place, Toggle

CAUSES = ("perception", "demonstration", "grasp", "drawer", "decision")


def cause_of(episode: RobotEpisode, number: int, misread: Iterable[tuple[str, str]] = ()) -> str:
    """What a dish that is not right failed by.

    Args:
        episode: As far as it has come.
        number: The dish's number.
        misread: Own category, and the one that it was taken for, of each dish that was misread in
            the demonstration.

    Returns:
        One of CAUSES.
    """
    category = episode.world.scene.dishes[number].category
    steps = [step for step in episode.steps if step.dish == number]
    found = _of_last_step(episode, number, steps[-1]) if steps else _of_waiting(episode, number)
    if found == "decision" and category in chain(*misread):
        return "demonstration"
    return found


def _of_last_step(episode: RobotEpisode, number: int, step: Step) -> str:
    """The cause where something was done with the dish."""
    if step.seen_as != episode.world.scene.dishes[number].category:
        return "perception"
    if step.result is Result.NOT_OPEN:
        return "drawer"
    if step.failed or not _is_where_it_was_put(episode, number, step):
        return "grasp"
    return "decision"


def _is_where_it_was_put(episode: RobotEpisode, number: int, step: Step) -> bool:
    """Whether a dish is in hand after a pick, or in the drawer after a drop."""
    if isinstance(step.decision, Place):
        return drawer_of(episode.world, number) == step.decision.drawer
    return episode.held == number


def _of_waiting(episode: RobotEpisode, number: int) -> str:
    """The cause where nothing was done with the dish."""
    if not is_on_table(episode.world, number):
        return "grasp"  # of another dish, which knocked this one down
    if episode.blind or not _is_seen(episode, number):
        return "perception"
    moves = [step for step in episode.steps if isinstance(step.decision, Toggle) and step.result]
    return "drawer" if moves and moves[-1].failed else "decision"


def _is_seen(episode: RobotEpisode, number: int) -> bool:
    """Whether the last look found a dish of its category on the table."""
    category = episode.world.scene.dishes[number].category
    return any(dish.seen.category == category for dish in episode.look.dishes)

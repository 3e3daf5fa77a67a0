"""What came of an episode: the paper's success, and what each dish that is not right failed by."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from kitchen_prefs_robot.execution.causes import cause_of
from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.step import Step
from kitchen_prefs_robot.execution.whereabouts import drawer_of
from kitchen_prefs_robot.scene.layout import DRAWERS
from kitchen_prefs_robot.task.decisions import Pick, Place
from kitchen_prefs_robot.task.metrics import in_order

# The version of what is counted below. 1 counted a dish as often as it was dropped, and let any
# failure that ever happened to a dish be its cause.
COUNTING = 2
CLOSED = 0.02  # m: a drawer that stands out by less is closed, to who passes by


@dataclass(frozen=True)
class EpisodeOutcome:
    """The facts of an episode.

    Attributes:
        dishes: How many there are.
        right: The share of dishes in the right drawer in the right order (paper, "Real-world").
        in_drawer: The share of dishes that lie in the right drawer, in whatever order.
        closed: Whether all is put away and both drawers are truly closed.
        decisions: How many decisions were made.
        refused: How many of them the rules did not allow.
        failed_picks: How many picks did not end with a dish in hand.
        misread: How many dishes were taken for another category when they were picked.
        shown: How many demonstrations were shown until one was understood.
        misread_when_shown: How many dishes of that one were taken for another category.
        blind: What the cameras did not see, in a sentence, which ended the episode; else empty.
        causes: How many of the dishes that are not right each cause explains, see `causes`.
        seconds: How long it took, of simulated time.
    """

    dishes: int
    right: float
    in_drawer: float
    closed: bool
    decisions: int
    refused: int
    failed_picks: int
    misread: int
    shown: int
    misread_when_shown: int
    blind: str
    causes: dict[str, int]
    seconds: float


def outcome_of(
    episode: RobotEpisode, shown: int = 1, misread: Sequence[tuple[str, str]] = ()
) -> EpisodeOutcome:
    """Measure an episode by where the dishes truly lie.

    Args:
        episode: As far as it has come.
        shown: How many demonstrations were shown until one was understood.
        misread: Own category, and the one that it was taken for, of each dish that was misread in
            that one.
    """
    world, steps, preference = episode.world, episode.steps, episode.preference
    categories = [dish.category for dish in world.scene.dishes]
    lies_in = [drawer_of(world, number) for number in range(len(categories))]
    wanted = [(c, drawer) for drawer in preference.drawers for c in preference.order(drawer)]
    done = [(categories[number], drawer) for number, drawer in placements(steps, lies_in)]
    right = {wanted[place][0] for place in in_order(done, wanted)}
    wrong = [number for number, category in enumerate(categories) if category not in right]
    closed = all(world.drawer_opening(drawer) < CLOSED for drawer in DRAWERS)
    return EpisodeOutcome(
        dishes=len(categories),
        right=len(right) / len(categories),
        in_drawer=sum(
            drawer == preference.drawer_of[c] for c, drawer in zip(categories, lies_in, strict=True)
        )
        / len(categories),
        closed=episode.terminated and None not in lies_in and closed,
        decisions=len(steps),
        refused=sum(bool(step.refusal) for step in steps),
        failed_picks=sum(step.failed and isinstance(step.decision, Pick) for step in steps),
        misread=_misread(steps, categories),
        shown=shown,
        misread_when_shown=len({category for category, _ in misread}),
        blind=episode.blind,
        causes=dict(Counter(cause_of(episode, number, misread) for number in wrong)),
        seconds=float(world.data.time),
    )


def outcome_without_prompt(dishes: int, shown: int) -> EpisodeOutcome:
    """The outcome where none of some demonstrations was understood: nothing is done."""
    return EpisodeOutcome(
        dishes=dishes,
        right=0.0,
        in_drawer=0.0,
        closed=False,
        decisions=0,
        refused=0,
        failed_picks=0,
        misread=0,
        shown=shown,
        misread_when_shown=0,
        blind="",
        causes={"demonstration": dishes},
        seconds=0.0,
    )


def placements(steps: Sequence[Step], lies_in: Sequence[str | None]) -> list[tuple[int, str]]:
    """The dishes that lie where they were dropped, in the order in which they came there.

    Args:
        steps: Of the episode.
        lies_in: The drawer that each dish lies in at its end, or None.

    Returns:
        Number and drawer of each dish, once: a dish that was dropped twice came there the last
        time.
    """
    came: dict[int, str] = {}
    for step in steps:
        dish, decision = step.dish, step.decision
        if dish is not None and isinstance(decision, Place) and decision.drawer == lies_in[dish]:
            came.pop(dish, None)
            came[dish] = decision.drawer
    return list(came.items())


def _misread(steps: Sequence[Step], categories: Sequence[str]) -> int:
    """How many dishes were in hand and taken for another category."""
    picked = (step for step in steps if isinstance(step.decision, Pick) and not step.failed)
    held_as = {step.dish: step.seen_as for step in picked if step.dish is not None}
    return sum(categories[number] != seen for number, seen in held_as.items())

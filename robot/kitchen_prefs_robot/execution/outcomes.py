"""What came of an episode: the paper's success, and what each dish that is not right failed by."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import bootstrap

from kitchen_prefs.metrics import Interval
from kitchen_prefs_robot.execution.episode import RobotEpisode, Step
from kitchen_prefs_robot.execution.whereabouts import drawer_of, is_on_table
from kitchen_prefs_robot.task.decisions import Place, Toggle
from kitchen_prefs_robot.task.metrics import in_order


@dataclass(frozen=True)
class EpisodeOutcome:
    """The facts of an episode.

    Attributes:
        dishes: How many there are.
        right: The share of dishes in the right drawer in the right order (paper, "Real-world").
        in_drawer: The share of dishes that lie in the right drawer, in whatever order.
        closed: Whether all is put away and both drawers are closed.
        decisions: How many decisions were made.
        refused: How many of them the rules did not allow.
        failed_picks: How many picks did not end with a dish in hand.
        misread: How many dishes were taken for another category when they were picked.
        causes: How many of the dishes that are not right each cause explains: perception, grasp,
            drawer or decision.
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
    causes: dict[str, int]
    seconds: float


def outcome_of(episode: RobotEpisode) -> EpisodeOutcome:
    """Measure an episode by where the dishes truly lie."""
    world, steps, preference = episode.world, episode.steps, episode.preference
    categories = [dish.category for dish in world.scene.dishes]
    lies_in = [drawer_of(world, number) for number in range(len(categories))]
    wanted = [(c, drawer) for drawer in preference.drawers for c in preference.order(drawer)]
    done = [(categories[n], drawer) for n, drawer in _placements(steps) if lies_in[n] == drawer]
    right = {wanted[place][0] for place in in_order(done, wanted)}
    wrong = [number for number, category in enumerate(categories) if category not in right]
    held_as = {step.dish: step.seen_as for step in steps if step.dish is not None}
    return EpisodeOutcome(
        dishes=len(categories),
        right=len(right) / len(categories),
        in_drawer=sum(
            drawer == preference.drawer_of[c] for c, drawer in zip(categories, lies_in, strict=True)
        )
        / len(categories),
        closed=episode.terminated and all(drawer is not None for drawer in lies_in),
        decisions=len(steps),
        refused=sum(bool(step.refusal) for step in steps),
        failed_picks=sum(_is_failed_pick(step) for step in steps),
        misread=sum(categories[number] != seen for number, seen in held_as.items()),
        causes=dict(Counter(_cause(episode, number) for number in wrong)),
        seconds=float(world.data.time),
    )


def mean_right(outcomes: Sequence[EpisodeOutcome]) -> Interval:
    """The mean share of dishes that are right, with the 95 % bootstrap interval over episodes."""
    values = np.array([one.right for one in outcomes])
    if len(values) < 2 or values.min() == values.max():  # the bootstrap has no width there
        return Interval(*3 * (float(values.mean()),))
    found = bootstrap((values,), np.mean, method="percentile", rng=0).confidence_interval
    return Interval(float(values.mean()), float(found.low), float(found.high))


def _placements(steps: list[Step]) -> list[tuple[int, str]]:
    """The dishes that were dropped, and into which drawer, in order."""
    return [
        (step.dish, step.decision.drawer)
        for step in steps
        if isinstance(step.decision, Place) and step.dish is not None
    ]


def _is_failed_pick(step: Step) -> bool:
    return step.failed and not isinstance(step.decision, Place | Toggle)


def _cause(episode: RobotEpisode, number: int) -> str:
    """What a dish that is not right failed by: the first of these that happened to it."""
    category = episode.world.scene.dishes[number].category
    about = [step for step in episode.steps if number == step.dish or step.seen_as == category]
    mine = [step for step in about if step.dish == number]
    if any(step.seen_as != category for step in mine):
        return "perception"
    if is_on_table(episode.world, number) and not _is_seen(episode, category):
        return "perception"
    if any(step.failed for step in about):
        return "grasp"
    if any(step.failed and isinstance(step.decision, Toggle) for step in episode.steps):
        return "drawer"
    return "decision"


def _is_seen(episode: RobotEpisode, category: str) -> bool:
    """Whether the last look found a dish of a category on the table."""
    return any(dish.seen.category == category for dish in episode.look.dishes)

"""The paper's success on hardware, and an episode as the kitchen's metrics read it."""

from collections.abc import Iterable, Sequence
from itertools import groupby, pairwise

from rapidfuzz.distance import LCSseq

from kitchen_prefs.metrics import Episode, Metric, edit_similarity, packing_efficiency
from kitchen_prefs.simulation.kitchen import FIRST_DISH, FIRST_PLACEMENT, RACK_INSTANCE
from kitchen_prefs_robot.task.decisions import Decision, Pick, Place, Toggle
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.rows import RACK_OF
from kitchen_prefs_robot.task.sessions import DrawersSession
from kitchen_prefs_robot.task.simulator import DrawersSimulator

IN_DRAWER = {drawer: f"in {rack}" for drawer, rack in RACK_OF.items()}  # the kitchen's words


def right_dishes(episode: Episode) -> float:
    """The share of dishes in the right drawer in the right order (paper, "Real-world").

    The longest sequence that policy and expert have in common of (category, drawer), a pair for
    each dish that was placed, by the number of the session's dishes.
    """
    refused_by_expert = [False] * len(episode.expert_kinds)
    expert = _placements(episode.expert_kinds, refused_by_expert)
    return len(in_order(_placements(episode.kinds, episode.refused), expert)) / len(expert)


def right_drawer(episode: Episode) -> float:
    """The share of dishes in the right drawer, in whatever order."""
    return sum(episode.placed) / sum(episode.expert_placed)


def in_order(done: Sequence[tuple[str, str]], wanted: Sequence[tuple[str, str]]) -> set[int]:
    """Which of the wanted placements were made in the right order.

    Args:
        done: Category and drawer of each dish, as placed.
        wanted: The same as it should be.

    Returns:
        The numbers of those among `wanted` that are in the longest sequence that both share.
    """
    return {
        place
        for block in LCSseq.opcodes(done, wanted)
        if block.tag == "equal"
        for place in range(block.dest_start, block.dest_end)
    }


METRICS: dict[str, Metric] = {
    "Right": right_dishes,
    "Drawer": right_drawer,
    "PE": packing_efficiency,
    "ED": edit_similarity,
}


def _placements(kinds: Iterable[str], refused: Iterable[bool]) -> list[tuple[str, str]]:
    """The category and the drawer of each dish, in the order in which they were placed."""
    pairs = zip(kinds, refused, strict=True)
    carried_out = [kind for kind, was_refused in pairs if not was_refused]
    return [pair for pair in pairwise(carried_out) if pair[1] in IN_DRAWER.values()]


def episode_of(simulator: DrawersSimulator) -> Episode:
    """The facts of an episode so far: drawers are racks, drop poses are placements."""
    session, decisions = simulator.session, simulator.decisions
    expert = demonstrate(session)
    drawer_of = session.preference.drawer_of
    standing = [(drawer_of[dish.category], dish.drawer) for dish in simulator.dishes if dish.drawer]
    wanted = [drawer_of[dish.category] for dish in session.start.dishes]
    return Episode(
        split=f"drawers {session.split}",
        session=session.index,
        salt=0,
        preference=session.label,
        count=len(wanted),
        decisions=tuple(map(_instance, decisions)),
        kinds=_kinds(session, decisions),
        expert_decisions=tuple(map(_instance, expert.decisions)),
        expert_kinds=_kinds(session, expert.decisions),
        placed=(standing.count(("upper", "upper")), standing.count(("lower", "lower"))),
        expert_placed=(wanted.count("upper"), wanted.count("lower")),
        wrong_rack=sum(right != drawer for right, drawer in standing),
        sunk=0,
        expert_sunk=0,
        refused=tuple(simulator.refused),
        blocked_places=0,
        longest_loop=_longest_loop(simulator),
        turns=(0, 0),
        closed_early=0,
        closed=simulator.opened is None,
        finished=simulator.terminated,
        actions=((),) * len(decisions),
    )


def _instance(decision: Decision) -> int:
    """The number that the kitchen gives to what a decision names."""
    if isinstance(decision, Toggle):
        return RACK_INSTANCE[RACK_OF[decision.drawer]]
    if isinstance(decision, Pick):
        return FIRST_DISH + decision.dish
    return FIRST_PLACEMENT[RACK_OF[decision.drawer]]


def _kinds(session: DrawersSession, decisions: Iterable[Decision]) -> tuple[str, ...]:
    """What each decision names, in the kitchen's words."""

    def kind(decision: Decision) -> str:
        if isinstance(decision, Toggle):
            return f"{RACK_OF[decision.drawer]} rack"
        if isinstance(decision, Pick):
            return session.start.dishes[decision.dish].category
        assert isinstance(decision, Place)
        return IN_DRAWER[decision.drawer]

    return tuple(map(kind, decisions))


def _longest_loop(simulator: DrawersSimulator) -> int:
    """The most times in a row that one refused decision was repeated."""
    pairs = zip(simulator.decisions, simulator.refused, strict=True)
    runs = ((was_refused, len(list(run))) for (_, was_refused), run in groupby(pairs))
    return max((length for was_refused, length in runs if was_refused), default=0)

"""The facts of one finished episode of the second tier, and its metrics."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class PeopleEpisode:
    """The facts of an episode and of the expert's episode from the same start.

    Attributes:
        split: The split's name.
        session: The session's index within the split.
        salt: The session seed; 0 is the published one.
        preference: The number of the session's user, whose preference it is, within the split.
        dishes: How many dishes there are.
        alike: How many of them end as the expert's do: like dishes in one zone, or in the sink,
            taken together.
        turns: How often a dish of the lowest rank was taken, and at how many decisions dishes of
            several ranks could be: of the policy, or of the expert if it had more of them.
        styled: How many dishes stand where the user's style puts them, and how many were put into
            their zone.
        by_hand_loaded: The dishes that are washed by hand and stand in a rack.
        decisions: The instances that the policy chose, see `kitchen_prefs.simulation.kitchen`.
        refused: For each of `decisions`, whether the kitchen could not carry it out.
        expert_decisions: How many decisions the expert takes.
        closed: Whether both racks were in and the door closed at the end.
        finished: Whether the episode ended by itself, not at the limit of decisions.
        actions: The actions given, 7 numbers (a pose) each.
    """

    split: str
    session: int
    salt: int
    preference: int
    dishes: int
    alike: int
    turns: tuple[int, int]
    styled: tuple[int, int]
    by_hand_loaded: int
    decisions: tuple[int, ...]
    refused: tuple[bool, ...]
    expert_decisions: int
    closed: bool
    finished: bool
    actions: tuple[tuple[float, ...], ...]


def where(episode: PeopleEpisode) -> float:
    """Where = sum over (identical dish, zone or sink) of min(policy, expert), over n."""
    return episode.alike / episode.dishes


def turn(episode: PeopleEpisode) -> float | None:
    """How often one of the lowest rank was taken, where dishes of several ranks could be.

    A policy that lets fewer such decisions happen than the expert has missed the others.

    Returns:
        A share, or None if the expert has no such decision, as with a user without an order.
    """
    return _share(episode.turns)


def style(episode: PeopleEpisode) -> float | None:
    """How often a dish that was put into its zone stands where the user's style puts it."""
    return _share(episode.styled)


def care(episode: PeopleEpisode) -> int:
    """How many dishes that are washed by hand were loaded: what hurts a person most."""
    return episode.by_hand_loaded


def refused_decisions(episode: PeopleEpisode) -> int:
    """How many decisions the kitchen could not carry out."""
    return sum(episode.refused)


def left_open(episode: PeopleEpisode) -> int:
    """Whether the episode ended with dishes left or something open, 0 or 1."""
    return int(not episode.finished)


def temporal_efficiency(episode: PeopleEpisode) -> float:
    """TE = Where · l / max(p, l), with the expert's and the policy's numbers of decisions."""
    expert = episode.expert_decisions
    return where(episode) * expert / max(len(episode.decisions), expert)


def success(episode: PeopleEpisode) -> bool:
    """Whether Where is 1 and the episode ended by itself: LeRobot's `is_success`."""
    return where(episode) == 1.0 and episode.finished


# What hurts a person comes first.
PEOPLE_METRICS: dict[str, Callable[[PeopleEpisode], float | None]] = {
    "Care": care,
    "Where": where,
    "Turn": turn,
    "Style": style,
    "Refused": refused_decisions,
    "Left open": left_open,
    "TE": temporal_efficiency,
}


def failure_modes(episode: PeopleEpisode) -> dict[str, int]:
    """How often each failure mode occurred in an episode; all 0 if nothing went wrong."""
    return {
        "loaded what is washed by hand": care(episode),
        "refused decision": refused_decisions(episode),
        "ran out of decisions": left_open(episode),
    }


def _share(counted: tuple[int, int]) -> float | None:
    right, of = counted
    return right / of if of else None

"""The facts of one finished episode, from which every metric is computed."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Episode:
    """The facts of one finished episode and of the expert's episode from the same start.

    Attributes:
        split: The split's name.
        session: The session's index within the split.
        salt: The session seed; 0 is the published one.
        preference: The label of the session's preference, which the expert follows.
        count: The dishes wanted per rack.
        decisions: The instances that the policy chose: 0 the door, 1 the bottom rack, 2 the top
            rack, 3 + i dish i, 999 the sink, 1000 + k placement k of the bottom rack, 2000 + k of
            the top rack.
        kinds: The kind of each of `decisions`: "door", "bottom rack", "top rack", the category of a
            dish, "in bottom", "in top" or "in sink".
        expert_decisions: The expert's decisions.
        expert_kinds: The kind of each of `expert_decisions`.
        placed: The dishes in the rack that the preference gives their category: (â, b̂).
        expert_placed: The same for the expert: (a, b).
        wrong_rack: The dishes in the other rack.
        sunk: The dishes dropped in the sink.
        expert_sunk: The dishes that the expert dropped in the sink.
        refused: For each of `decisions`, whether the kitchen could not carry it out.
        blocked_places: How often a placement was chosen that another dish blocks.
        longest_loop: The most repetitions of one refused decision in a row.
        turns: How often a dish of the lowest rank was picked, and at how many decisions dishes of
            several ranks waited; see `scores.turn_accuracy`.
        closed_early: How often the door was closed with dishes on the counter or still to come.
        closed: Whether both racks were in and the door closed at the end.
        finished: Whether the episode ended by itself, not at the limit of decisions.
        actions: The actions given, 7 numbers (a pose) each.

    Raises:
        ValueError: If there is no expert to compare with, or if the lengths do not agree.
    """

    split: str
    session: int
    salt: int
    preference: int
    count: int
    decisions: tuple[int, ...]
    kinds: tuple[str, ...]
    expert_decisions: tuple[int, ...]
    expert_kinds: tuple[str, ...]
    placed: tuple[int, int]
    expert_placed: tuple[int, int]
    wrong_rack: int
    sunk: int
    expert_sunk: int
    refused: tuple[bool, ...]
    blocked_places: int
    longest_loop: int
    turns: tuple[int, int]
    closed_early: int
    closed: bool
    finished: bool
    actions: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        where = f"session {self.session} of {self.split}"
        if not self.expert_decisions:
            raise ValueError(f"The expert decides nothing in {where}; there is nothing to compare.")
        of_policy = {len(self.decisions), len(self.kinds), len(self.refused), len(self.actions)}
        if len(of_policy) > 1 or len(self.expert_decisions) != len(self.expert_kinds):
            raise ValueError(f"The decisions of {where} and the facts about them differ in length.")

"""Infers a preference from a prompt, by rule and without learning."""

from collections import Counter, defaultdict
from collections.abc import Iterator

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.preferences import CATEGORIES, SEEN, TOP_CATEGORIES, Preference
from kitchen_prefs.simulation.expert import choose
from lerobot_policy_kitchen_prefs.rules.observed_view import Memory, ObservedView


def decisions_of(prompt: np.ndarray) -> Iterator[tuple[np.ndarray, int]]:
    """Split a prompt into decisions.

    Args:
        prompt: (P, D + 1), padded; the last column marks the chosen rows.

    Yields:
        The instance set of each decision, (n, D), and its chosen row.
    """
    rows = instances.unpad(prompt)
    starts = np.flatnonzero(np.diff(rows[:, instances.DECISION], prepend=-1))
    for part in np.split(rows, starts[1:]):
        yield part[:, :-1], int(part[:, -1].argmax())


def symbolic_preference(prompt: np.ndarray) -> Preference:
    """Infer the preference of a demonstration.

    The first rack is the one that is opened first; a category's rack is where most of its dishes
    go; of two categories of a rack, the earlier one is picked while the other waits.
    What the prompt leaves open follows the order of CATEGORIES.

    Args:
        prompt: (P, 14), padded.

    Returns:
        The preference.
    """
    first: str | None = None
    racks: dict[str, Counter[str]] = defaultdict(Counter)
    picks: list[tuple[str, set[str]]] = []  # the category picked, and those that waited
    for rows, chosen in decisions_of(prompt):
        view = ObservedView(rows)
        if first is None and chosen in view.racks.values():
            first = next(rack for rack, row in view.racks.items() if row == chosen)
        if view.held is not None and view.open_rack is not None and chosen != view.sink:
            racks[view.held][view.open_rack] += 1
        if view.held is None and view.open_rack is not None:
            waiting = view.waiting()
            if chosen in [option.choice for option in waiting]:
                picks.append((view.category(chosen), {option.category for option in waiting}))
    top, bottom = _partition({c: racks[c].most_common(1)[0][0] for c in CATEGORIES if racks[c]})
    return Preference(first or "top", _ordered(top, picks), _ordered(bottom, picks))


def _partition(rack_of: dict[str, str]) -> tuple[list[str], list[str]]:
    """Three categories for the top, four for the bottom; the unknown fill the remaining slots."""
    top = [category for category in CATEGORIES if rack_of.get(category) == "top"]
    unknown = [category for category in CATEGORIES if category not in rack_of]
    bottom = [category for category in CATEGORIES if rack_of.get(category) == "bottom"]
    together = top + unknown + bottom
    return together[:TOP_CATEGORIES], together[TOP_CATEGORIES:]


def _ordered(categories: list[str], picks: list[tuple[str, set[str]]]) -> tuple[str, ...]:
    before = {c: set[str]() for c in categories}
    for picked, waiting in picks:
        if picked in before:
            before[picked] |= (waiting & set(categories)) - {picked}
    for middle in categories:  # Warshall: before is transitive
        for one in categories:
            if middle in before[one]:
                before[one] |= before[middle] - {one}
    first_pick = {picked: -i for i, (picked, _) in reversed(list(enumerate(picks)))}
    never = -len(picks)
    return tuple(
        sorted(categories, key=lambda c: (len(before[c]), first_pick.get(c, never)), reverse=True)
    )


def nearest_training_preference(prompt: np.ndarray) -> Preference:
    """The training preference under which the expert takes most of a prompt's decisions.

    Args:
        prompt: (P, 14), padded.

    Returns:
        One of the seven; the first on a tie.
    """
    decisions = list(decisions_of(prompt))
    return max(SEEN, key=lambda preference: _agreement(decisions, preference))


def _agreement(decisions: list[tuple[np.ndarray, int]], preference: Preference) -> int:
    memory = Memory()
    return sum(
        choose(ObservedView(rows, memory), preference) == chosen for rows, chosen in decisions
    )

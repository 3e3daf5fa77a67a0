"""Replays the file of a demonstration in the kitchen."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from kitchen_prefs.envs.demonstrations import Demonstration, as_prompt, record
from kitchen_prefs.simulation.kitchen import Kitchen, Location, decision_kind
from kitchen_prefs.simulation.sessions import Session, make_session
from kitchen_prefs.splits import DATA_VERSION, get_split
from kitchen_prefs_demonstrations.file_format import DemonstrationFile, read_demonstration


@dataclass(frozen=True, eq=False)
class ReplayedDemonstration:
    """A demonstration that the kitchen carried out.

    Attributes:
        file: The file's content.
        session: The session that it starts in.
        kitchen: The kitchen as it leaves it; not to be changed.
    """

    file: DemonstrationFile
    session: Session
    kitchen: Kitchen

    @property
    def decisions(self) -> list[int]:
        """The chosen instances."""
        return self.file.decisions

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kind of each decision, see `kitchen.decision_kind`."""
        return tuple(decision_kind(instance, self.session.dishes) for instance in self.decisions)

    @property
    def finished(self) -> bool:
        """Whether every dish is put away and everything is closed."""
        return self.kitchen.finished

    @cached_property
    def frames(self) -> Demonstration:
        """Its frames, with rewards and label of the session's own user, whom it does not follow."""
        return record(self.session, self.decisions)

    @cached_property
    def prompt(self) -> np.ndarray:
        """The demonstration as a prompt, (1664, 14) float32.

        Raises:
            ValueError: If it does not fit.
        """
        return as_prompt(self.frames)


def read_and_replay(file: Path) -> ReplayedDemonstration:
    """Read a demonstration's file and replay it.

    Raises:
        ValueError: If it is no demonstration; see `replay`.
    """
    return replay(read_demonstration(file), str(file))


def replay(demonstration: DemonstrationFile, where: str) -> ReplayedDemonstration:
    """Replay a demonstration.

    One that is not finished is a demonstration all the same, if at least one dish is in a rack: it
    shows a rack, which is what a prompt is for.

    Args:
        demonstration: The file's content.
        where: Names the file in errors.

    Raises:
        ValueError: If its session does not exist or is of another data version, if the kitchen
            refuses a decision, or if it shows nothing or more than a prompt holds.
    """
    session = _session(demonstration, where)
    kitchen = Kitchen(session.dishes)
    for number, instance in enumerate(demonstration.decisions, start=1):
        if kitchen.finished:
            raise ValueError(f"{where}: the kitchen is finished before decision {number}.")
        if refusal := kitchen.decide(instance):
            raise ValueError(
                f"{where}: the kitchen refuses decision {number} ({instance}): {refusal}"
            )
    _check_shows_something(kitchen, where)
    replayed = ReplayedDemonstration(demonstration, session, kitchen)
    try:
        _ = replayed.prompt
    except ValueError as error:
        raise ValueError(
            f"{where} is longer than a prompt may be; move the door and the racks less often."
        ) from error
    return replayed


def _session(demonstration: DemonstrationFile, where: str) -> Session:
    if demonstration.data_version != DATA_VERSION:
        raise ValueError(
            f"{where} is of data version {demonstration.data_version}, but this kitchen_prefs "
            f"replays version {DATA_VERSION}; give the demonstration again on its page."
        )
    try:
        split = get_split(demonstration.split)
        session = make_session(split.name, demonstration.session, demonstration.salt)
    except ValueError as error:
        raise ValueError(f"{where} starts in no known kitchen: {error}") from error
    if split.noisy:
        raise ValueError(f"{where} starts in {split.name!r}, where picks fail at random.")
    return session


def _check_shows_something(kitchen: Kitchen, where: str) -> None:
    if kitchen.held is not None:
        raise ValueError(f"{where} ends with a dish in hand; put it somewhere.")
    if not np.isin(kitchen.location, (Location.BOTTOM, Location.TOP)).any():
        raise ValueError(f"{where} puts no dish into a rack, so it shows nothing.")

"""How a motion can end: always in one of these, never in an exception or a wait without end."""

from dataclasses import dataclass
from enum import StrEnum


class Result(StrEnum):
    """The end of a motion as the arm feels it; what became of the dish, the cameras must see."""

    DONE = "done"  # grasped, dropped into the drawer, opened or closed
    MISSED = "missed"  # the fingers closed on nothing
    DROPPED = "dropped"  # it was held and slipped out on the way
    UNREACHABLE = "unreachable"  # no grasp or no path was found; the arm has not moved
    NOT_OPEN = "not open"  # the drawer is not open far enough to drop into; the arm has not moved
    JAMMED = "jammed"  # the drawer did not move all its way
    TIMED_OUT = "timed out"  # something was in the arm's way, and it gave up


@dataclass(frozen=True)
class Outcome:
    """The end of a motion.

    Attributes:
        result: How it ended.
        seconds: How long it took, of simulated time.
    """

    result: Result
    seconds: float

    @property
    def succeeded(self) -> bool:
        """Whether all went well."""
        return self.result is Result.DONE

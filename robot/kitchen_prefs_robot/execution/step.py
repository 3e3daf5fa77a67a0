"""One decision and what came of it."""

from dataclasses import dataclass

from kitchen_prefs_robot.motion.outcomes import Result
from kitchen_prefs_robot.task.decisions import Decision
from kitchen_prefs_robot.task.state import DrawersState


@dataclass(frozen=True)
class Step:
    """One decision and what came of it.

    Attributes:
        state: What was known before it.
        decision: The decision; a dish has its number in that state.
        refusal: Why the rules of the drawers do not allow it, or an empty string.
        result: How the motion ended; None where it was refused.
        seen_as: The category that its dish was taken for; None if it is about no dish.
        dish: The true number of that dish: the one in hand or, after a pick that failed, the one
            that was reached for; None where there is none, or the decision was refused.
    """

    state: DrawersState
    decision: Decision
    refusal: str
    result: Result | None
    seen_as: str | None
    dish: int | None

    @property
    def failed(self) -> bool:
        """Whether a motion was tried and did not do what it should."""
        return self.result not in (None, Result.DONE)

"""The decisions and their rules: what can be chosen in a state, and what is refused."""

from dataclasses import dataclass

from kitchen_prefs_robot.task.state import DRAWERS, DrawersState


@dataclass(frozen=True)
class Toggle:
    """Open a closed drawer, or close an open one."""

    drawer: str


@dataclass(frozen=True)
class Pick:
    """Take a dish, by its number among the state's dishes."""

    dish: int


@dataclass(frozen=True)
class Place:
    """Drop the dish in hand into a drawer."""

    drawer: str


Decision = Toggle | Pick | Place


def choices(state: DrawersState) -> tuple[Decision, ...]:
    """What a decision can name, refused or not, in the order of the rows of `rows.observe`.

    Both drawers, the dishes on the table and in the open drawer, and, with a dish in hand, the open
    drawer as its place.
    """
    dishes = (i for i, dish in enumerate(state.dishes) if dish.drawer in (None, state.opened))
    place = [Place(state.opened)] if state.in_hand and state.opened else []
    return (*map(Toggle, DRAWERS), *map(Pick, dishes), *place)


def refusal(state: DrawersState, decision: Decision) -> str:
    """Why a decision cannot be carried out, or an empty string."""
    if isinstance(decision, Place):
        if state.in_hand is None:
            return "There is no dish in hand."
        return "" if decision.drawer == state.opened else "A dish goes only into the open drawer."
    if state.in_hand is not None:
        return "The hand holds a dish, which has to be placed first."
    if isinstance(decision, Toggle):
        if state.opened in (None, decision.drawer):
            return ""
        return "A drawer moves only with the other one closed."
    if state.dishes[decision.dish].drawer is not None:
        return "Only a dish on the table can be picked; one in a drawer stays there."
    return "" if state.opened else "A dish is picked only for an open drawer, and both are closed."


def is_finished(state: DrawersState) -> bool:
    """Whether all dishes are in drawers and both drawers are closed."""
    in_drawers = all(dish.drawer is not None for dish in state.dishes)
    return in_drawers and state.in_hand is None and state.opened is None

"""Session i of a split of the second tier: its user, its dishes and its prompts.

A session is a pure function of (data version, split, salt, i); the salt is the session seed, 0 for
the published sessions. The dishes are drawn without a look at the user. Of a certified split the
prompts are drawn until they tell enough of the session; the few users of whom no prompt does are
drawn anew, together with their dishes. In training the sessions of a user prompt each other, so
they are not chosen: sessions that tell much of a user would give rules away by what they contain.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import count
from zlib import crc32

import numpy as np

from kitchen_prefs.people.attributes import DescribedDishes, draw_dishes
from kitchen_prefs.people.certificates import is_certified
from kitchen_prefs.people.drawings import Drawing, published_drawings
from kitchen_prefs.people.evidence import Evidence, evidence_of
from kitchen_prefs.people.expert import PlanExpert, roll_out_plan
from kitchen_prefs.people.posterior import Posterior
from kitchen_prefs.people.splits import (
    COUNTS,
    PEOPLE_DATA_VERSION,
    PeopleSplit,
    get_people_split,
)
from kitchen_prefs.people.user_sampling import COMPOSED, pairs_of, sample_polled_user, sample_user
from kitchen_prefs.people.users import LoadingPlan, User
from kitchen_prefs.people.zones import SINK_ZONE, ZONES
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.expert import ExpertTrajectory
from kitchen_prefs.simulation.kitchen import Kitchen, PlacementTable, placement_table
from kitchen_prefs.simulation.placements import LARGEST
from kitchen_prefs.simulation.sessions import check_session

# Sets of prompts that are tried before the user is drawn anew; one in four is certified.
ATTEMPTS = 40


@dataclass(frozen=True, eq=False)
class UserDemonstration:
    """One way in which a user loads some dishes.

    Attributes:
        dishes: The dishes.
        plan: How they are loaded.
    """

    dishes: DescribedDishes
    plan: LoadingPlan

    @cached_property
    def trajectory(self) -> ExpertTrajectory:
        """What the expert does; its kitchen is finished and not to be changed."""
        return roll_out_plan(Kitchen(self.dishes, people_table()), self.plan)

    @cached_property
    def evidence(self) -> Evidence:
        """What it says of the user."""
        return evidence_of(self.dishes, people_table(), self.trajectory.decisions)


@dataclass(frozen=True, eq=False)
class PeopleSession:
    """One session of the second tier.

    Attributes:
        split: Its split's name.
        index: Its number in the split.
        salt: The session seed; 0 for the published sessions.
        user: The user who is to be served.
        dishes: The dishes, in the order in which they arrive.
        prompts: The demonstrations that prompt an episode.
        evening: Which of the prompts is of the user; 0 but where they are of two users.
    """

    split: str
    index: int
    salt: int
    user: User
    dishes: DescribedDishes
    prompts: tuple[UserDemonstration, ...]
    evening: int = 0

    @cached_property
    def expert(self) -> UserDemonstration:
        """How the user loads the session's dishes."""
        return UserDemonstration(self.dishes, self.user.plan(self.dishes))

    @cached_property
    def expert_turns(self) -> int:
        """At how many decisions the user could take dishes of several ranks."""
        kitchen = Kitchen(self.dishes, people_table())
        expert, turns = PlanExpert(kitchen, self.expert.plan), 0
        for decision in self.expert.trajectory.decisions:
            turns += expert.in_turn() is not None
            kitchen.decide(decision)
        return turns

    @property
    def own_prompts(self) -> tuple[UserDemonstration, ...]:
        """The prompts of the user who is to be served: all, or that of whose evening it is."""
        if get_people_split(self.split).evening:
            return (self.prompts[self.evening],)
        return self.prompts

    def generator(self, purpose: str) -> np.random.Generator:
        """A fresh generator for one purpose, the same in every process."""
        return _generator(self.split, self.salt, self.index, purpose)


def people_table() -> PlacementTable:
    """Where the dishes of the second tier can stand: the placements of its largest dishes."""
    return placement_table(LARGEST)


@lru_cache(maxsize=4096)
def make_people_session(split: str, index: int, salt: int = 0) -> PeopleSession:
    """Make one session.

    Args:
        split: A split's name.
        index: 0 <= index < the split's size.
        salt: The session seed; 0 gives the published session.

    Returns:
        The session, the same in every process.

    Raises:
        ValueError: If the split, the index or the salt does not exist.
    """
    where = get_people_split(split)
    check_session(split, where.sessions, index, salt)
    if where.sessions_each > 1:
        return _sessions_of_user(where, where.user(index), salt)[index % where.sessions_each]
    session = _draw_session(where, index, salt, _drawing(where, index, salt))
    return _with_somebody_else(session, where) if where.evening else session


def search_drawing(split: PeopleSplit, index: int, salt: int) -> Drawing:
    """The first drawing of a session in which the prompts are certified."""
    for attempt in count():
        for again in range(ATTEMPTS):
            drawing = Drawing(attempt, again)
            session = _draw_session(split, index, salt, drawing)
            if _certified(session.prompts, session.dishes):
                return drawing
    raise AssertionError("Unreachable: some user is certified.")


def _drawing(split: PeopleSplit, index: int, salt: int) -> Drawing:
    """Which drawing a session is; that of the published sessions is recorded."""
    if not split.certified:
        return Drawing(0, 0)
    if salt == 0:
        return published_drawings()[split.name][index]
    return search_drawing(split, index, salt)


@lru_cache(maxsize=4096)
def _sessions_of_user(split: PeopleSplit, number: int, salt: int) -> tuple[PeopleSession, ...]:
    """The sessions of a user who has several; each is prompted by all the others."""
    first = number * split.sessions_each
    user = _draw_user(split, _generator(split.name, salt, first, "user"))
    indices = range(first, first + split.sessions_each)
    dishes = [
        draw_dishes(split.count(i), _generator(split.name, salt, i, "dishes")) for i in indices
    ]
    shown = [_shown(user, one) for one in dishes]
    return tuple(
        PeopleSession(split.name, i, salt, user, own.dishes, tuple(o for o in shown if o != own))
        for i, own in zip(indices, shown, strict=True)
    )


def _draw_session(split: PeopleSplit, index: int, salt: int, drawing: Drawing) -> PeopleSession:
    """One drawing of a session's user, dishes and prompts."""

    def generator(purpose: str) -> np.random.Generator:
        return _generator(split.name, salt, index, f"{purpose} {drawing.user}")

    user = _draw_user(split, generator("user"))
    dishes = draw_dishes(split.count(index), generator("dishes"))
    prompts = _draw_prompts(split, user, generator(f"prompts {drawing.prompts}"))
    return PeopleSession(split.name, index, salt, user, dishes, prompts)


def _draw_prompts(
    split: PeopleSplit, user: User, generator: np.random.Generator
) -> tuple[UserDemonstration, ...]:
    """Draw the demonstrations of a user that prompt an episode."""
    prompts = []
    for _ in range(1 if split.evening else split.prompts):
        lacking = generator.choice(len(CATEGORIES), split.lacking, replace=False)
        dishes = draw_dishes(int(generator.choice(COUNTS)), generator, tuple(lacking.tolist()))
        prompts.append(_shown(user, dishes, split.slips, generator))
    return tuple(prompts)


def _with_somebody_else(session: PeopleSession, split: PeopleSplit) -> PeopleSession:
    """The session with another user's demonstration before or after the prompt."""
    generator = session.generator("somebody else")
    other = _draw_prompts(split, _draw_user(split, generator), generator)
    evening = int(generator.integers(2))
    prompts = (*other, *session.prompts)[:: 1 if evening else -1]
    return replace(session, prompts=prompts, evening=evening)


def _draw_user(split: PeopleSplit, generator: np.random.Generator) -> User:
    """Draw a user of a split's kind."""
    while True:
        user = sample_polled_user(generator) if split.polled else sample_user(generator)
        if bool(pairs_of(user) & COMPOSED) == split.composed:
            return user


def _shown(
    user: User,
    dishes: DescribedDishes,
    slips: float = 0.0,
    generator: np.random.Generator | None = None,
) -> UserDemonstration:
    """How a user loads some dishes, with slips into other zones at a rate."""
    plan = user.plan(dishes)
    if generator is None or slips == 0:
        return UserDemonstration(dishes, plan)
    slipped = generator.random(len(plan.zones)) < slips
    elsewhere = (plan.zones + generator.integers(1, len(ZONES), len(plan.zones))) % len(ZONES)
    anywhere = generator.integers(len(ZONES), size=len(plan.zones))
    elsewhere = np.where(plan.zones == SINK_ZONE, anywhere, elsewhere)
    return UserDemonstration(dishes, replace(plan, zones=np.where(slipped, elsewhere, plan.zones)))


def _certified(prompts: Sequence[UserDemonstration], dishes: DescribedDishes) -> bool:
    posterior = Posterior([prompt.evidence for prompt in prompts])
    return is_certified(posterior, dishes, people_table())


def _generator(split: str, salt: int, index: int, purpose: str) -> np.random.Generator:
    seed = [PEOPLE_DATA_VERSION, crc32(split.encode()), salt, index, crc32(purpose.encode())]
    return np.random.default_rng(seed)

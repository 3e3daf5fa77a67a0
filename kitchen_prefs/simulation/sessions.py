"""Session i of a split: its user, its dishes with their poses, and its prompts.

A session is a pure function of (data version, split, salt, i). The salt is the session seed: 0
gives the published sessions, any other natural number fresh ones. Each purpose draws from a
generator of its own.
"""

from dataclasses import dataclass
from functools import lru_cache
from zlib import crc32

import numpy as np

from kitchen_prefs.preferences import (
    CATEGORIES,
    RACKS,
    SPACE_SIZE,
    TWELVE,
    Preference,
    preference_from_number,
    preference_number,
)
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.counter_layout import lay_counter
from kitchen_prefs.simulation.expert import ExpertTrajectory, roll_out_expert
from kitchen_prefs.simulation.kitchen import Dishes, Kitchen
from kitchen_prefs.splits import (
    DATA_VERSION,
    HELD_OUT_USERS,
    OTHER_USERS,
    SEEN_USERS,
    get_split,
)

# From this salt on the five held-out users, too, have preferences that are drawn anew: a re-run's
# users are then users whom nobody has published. The seven of training stay.
FRESH_USERS = 2**31
# From this salt on the five are the published ones again. Both ranges have more salts than a policy
# can try until one gives the session that it observes: 2**31 would take it nine hours.
PUBLISHED_USERS = 2**52
LEAST_PRESENT = 0.5  # at least half of the dishes stand there at the start


@dataclass(frozen=True)
class Session:
    """One session.

    Attributes:
        split: Its split's name.
        index: Its number in the split.
        salt: The session seed; 0 for the published sessions.
        user: The number of its user, see `splits`.
        preference: The user's preference.
        count: How many dishes are wanted per rack.
        dishes: The dishes, in the order in which they arrive.
    """

    split: str
    index: int
    salt: int
    user: int
    preference: Preference
    count: int
    dishes: Dishes

    @property
    def label(self) -> int:
        """The preference's label: 0..11 the twelve, 12 + its number in the space for any other."""
        return label_of(self.preference)

    def generator(self, purpose: str) -> np.random.Generator:
        """A fresh generator for one purpose, the same in every process."""
        return _generator(self.split, self.salt, self.index, purpose)


def _generator(split: str, salt: int, index: int, purpose: str) -> np.random.Generator:
    seed = [DATA_VERSION, crc32(split.encode()), salt, index, crc32(purpose.encode())]
    return np.random.default_rng(seed)


@lru_cache(maxsize=4096)
def make_session(
    split: str, index: int, salt: int = 0, preference: Preference | None = None
) -> Session:
    """Make one session.

    Args:
        split: A split's name.
        index: 0 <= index < the split's size.
        salt: The session seed; 0 gives the published session.
        preference: What the user prefers instead, so that the dishes are drawn for that; None for
            what the split's user prefers.

    Returns:
        The session, the same in every process.

    Raises:
        ValueError: If the split, the index or the salt does not exist.
    """
    where = get_split(split)
    check_session(split, where.sessions, index, salt)
    user = where.users[index]
    preference = preference or _preference_of(user, salt)
    generator = _generator(split, salt, index, "dishes")
    without = _left_out(user, index) if where.incomplete else None
    while True:
        dishes = _draw_dishes(preference, where.count(index), without, generator)
        session = Session(split, index, salt, user, preference, where.count(index), dishes)
        if not where.serves_prompts or _shows_every_category(session):
            return session


def check_session(split: str, sessions: int, index: int, salt: int) -> None:
    """Make sure that a split of so many sessions has one.

    Raises:
        ValueError: If the index or the salt does not exist.
    """
    if not 0 <= index < sessions:
        raise ValueError(f"Split {split!r} has the sessions 0..{sessions - 1}, not {index}.")
    if salt < 0:
        raise ValueError(f"A salt is a natural number, not {salt}.")


@lru_cache(maxsize=4096)
def expert_trajectory(session: Session) -> ExpertTrajectory:
    """What the expert does in a session; its kitchen is finished and not to be changed."""
    return roll_out_expert(Kitchen(session.dishes), session.preference)


def prompt_session(session: Session, of: str = "same") -> Session:
    """The session whose demonstration is a session's prompt, see `prompt_sessions`."""
    return prompt_sessions(session, of, 1)[0]


def prompt_sessions(session: Session, of: str, count: int) -> tuple[Session, ...]:
    """The sessions whose demonstrations are a session's prompts, all different.

    Prompts of seen preferences come from `train`, those of the others from `prompts`, with the same
    salt; never the session itself where there is another one.

    Args:
        session: The situation.
        of: "same" for right prompts, "other" for those of another preference of the split.
        count: How many; the first of several is the only one of one.

    Raises:
        ValueError: If `of` is neither, or if there are not so many sessions to prompt with.
    """
    if of not in ("same", "other"):
        raise ValueError(f"A prompt is of the 'same' or of an 'other' preference, not {of!r}.")
    generator = session.generator(f"prompt of {of}")
    split, user = get_split(session.split), session.user
    if of == "other":
        user = int(generator.choice(sorted(set(split.users) - {user})))
    elsewhere = get_split("train" if user in SEEN_USERS else "prompts")
    source = split if split.incomplete else elsewhere
    candidates = [i for i, candidate in enumerate(source.users) if candidate == user]
    if source == split and len(candidates) > 1:
        candidates = [i for i in candidates if i != session.index]
    if not 1 <= count <= len(candidates):
        raise ValueError(
            f"An episode of {session.split!r} has 1 to {len(candidates)} prompts, not {count}."
        )
    first = int(generator.choice(candidates))
    more = generator.permutation([i for i in candidates if i != first])[: count - 1].tolist()
    return tuple(make_session(source.name, index, session.salt) for index in (first, *more))


def label_of(preference: Preference) -> int:
    """A preference's label: 0..11 for the twelve, 12 + its number in the space for any other."""
    if preference in TWELVE:
        return TWELVE.index(preference)
    return len(TWELVE) + preference_number(preference)


def preference_with(label: int) -> Preference:
    """The preference with a label.

    Raises:
        ValueError: If there is none.
    """
    if 0 <= label < len(TWELVE):
        return TWELVE[label]
    return preference_from_number(label - len(TWELVE))


def _preference_of(user: int, salt: int) -> Preference:
    """A user's preference; those from 12 on are drawn anew for each salt, see `FRESH_USERS`."""
    if user in OTHER_USERS:
        return _other_preferences(salt)[user - OTHER_USERS[0]]
    if user in HELD_OUT_USERS and FRESH_USERS <= salt < PUBLISHED_USERS:
        return _other_preferences(salt)[len(OTHER_USERS) + user - HELD_OUT_USERS[0]]
    return TWELVE[user]


@lru_cache
def _other_preferences(salt: int) -> tuple[Preference, ...]:
    """The preferences of the other users, and then those of the held-out users when drawn anew."""
    numbers = _generator("many_preferences", salt, 0, "preferences").permutation(SPACE_SIZE)
    others = (p for p in map(preference_from_number, numbers.tolist()) if p not in TWELVE)
    return tuple(next(others) for _ in (*OTHER_USERS, *HELD_OUT_USERS))


def _shows_every_category(session: Session) -> bool:
    trajectory = expert_trajectory(session)
    racked = session.dishes.category[trajectory.kitchen.placement >= 0]
    return len(np.unique(racked)) == len(CATEGORIES)


def _left_out(user: int, index: int) -> str:
    """The category that a session of an incomplete split lacks: another one in each of its five."""
    return CATEGORIES[(user + index) % len(CATEGORIES)]


def _draw_dishes(
    preference: Preference, count: int, without: str | None, generator: np.random.Generator
) -> Dishes:
    names: list[str] = []
    for rack in RACKS:
        order = [category for category in preference.order(rack) if category != without]
        once = list(generator.permutation(order))[:count]
        names += once + list(generator.choice(order, size=count - len(once)))
    category = np.array([CATEGORIES.index(name) for name in generator.permutation(names)], np.int8)
    present = round(generator.uniform(LEAST_PRESENT, 1) * len(category))
    extents = np.array([layout.EXTENTS[CATEGORIES[c]] for c in category])  # (n, 3)
    return Dishes(category, lay_counter(extents, generator), max(present, 1))

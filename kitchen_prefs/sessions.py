"""What session i of a split is: whose dishwasher, which dishes, where they stand, which prompt.

A session is a pure function of (data version, split, salt, i). Salt 0 is published, others give
fresh sessions. Each purpose draws from a generator of its own.
"""

from dataclasses import dataclass
from functools import lru_cache
from zlib import crc32

import numpy as np

from kitchen_prefs.expert import Run, run_expert
from kitchen_prefs.kitchen import Dishes, Kitchen
from kitchen_prefs.preferences import (
    CATEGORIES,
    RACKS,
    SPACE_SIZE,
    TWELVE,
    Preference,
    preference_from_number,
    preference_number,
)
from kitchen_prefs.scene import layout
from kitchen_prefs.splits import DATA_VERSION, OTHER_PEOPLE, SEEN_PEOPLE, get_split

LEAST_PRESENT = 0.5  # at least half of the dishes stand there at the start
DISH_GAP = 0.01  # m between dishes on the counter: fingers fit in
COUNTER_MARGIN = 0.02  # m to the counter's edges and the sink's
POSE_DECIMALS = 4  # a tenth of a millimetre: no machine's last digit shows in the data
TRIES_PER_DISH = 200  # before the whole counter is laid anew


@dataclass(frozen=True)
class Session:
    """One session.

    Attributes:
        split: Its split's name.
        index: Its number in the split.
        salt: 0 for the published sessions.
        person: Whose dishwasher it is, see `splits`.
        preference: How this person likes it loaded.
        count: How many dishes are wanted per rack.
        dishes: The dishes, in the order in which they arrive.
    """

    split: str
    index: int
    salt: int
    person: int
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
def make_session(split: str, index: int, salt: int = 0) -> Session:
    """Make one session.

    Args:
        split: A split's name.
        index: 0 <= index < the split's size.
        salt: 0 gives the published session; any other natural number a fresh one.

    Returns:
        The session, the same in every process.

    Raises:
        ValueError: If the split, the index or the salt does not exist.
    """
    where = get_split(split)
    if not 0 <= index < where.sessions:
        raise ValueError(f"Split {split!r} has the sessions 0..{where.sessions - 1}, not {index}.")
    if salt < 0:
        raise ValueError(f"A salt is a natural number, not {salt}.")
    person = where.people[index]
    preference = _preference_of(person, salt)
    generator = _generator(split, salt, index, "dishes")
    without = _left_out(person, index) if where.incomplete else None
    while True:
        dishes = _draw_dishes(preference, where.count(index), without, generator)
        session = Session(split, index, salt, person, preference, where.count(index), dishes)
        if not where.serves_prompts or _shows_every_category(session):
            return session


@lru_cache(maxsize=4096)
def expert_run(session: Session) -> Run:
    """What the expert does in a session; its kitchen is finished and not to be changed."""
    return run_expert(Kitchen(session.dishes), session.preference)


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
    split, person = get_split(session.split), session.person
    if of == "other":
        person = int(generator.choice(sorted(set(split.people) - {person})))
    if split.incomplete:
        source = split
    else:
        source = get_split("train" if person in SEEN_PEOPLE else "prompts")
    candidates = [i for i, candidate in enumerate(source.people) if candidate == person]
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


def _preference_of(person: int, salt: int) -> Preference:
    """How a person likes it; those from 12 on are drawn anew for each salt."""
    return (
        TWELVE[person] if person < len(TWELVE) else _other_preferences(salt)[person - len(TWELVE)]
    )


@lru_cache
def _other_preferences(salt: int) -> tuple[Preference, ...]:
    numbers = _generator("many_preferences", salt, 0, "preferences").permutation(SPACE_SIZE)
    others = (p for p in map(preference_from_number, numbers.tolist()) if p not in TWELVE)
    return tuple(next(others) for _ in OTHER_PEOPLE)


def _shows_every_category(session: Session) -> bool:
    run = expert_run(session)
    racked = session.dishes.category[run.kitchen.placement >= 0]
    return len(np.unique(racked)) == len(CATEGORIES)


def _left_out(person: int, index: int) -> str:
    """The category that a session of an incomplete split lacks: another one in each of its five."""
    return CATEGORIES[(person + index) % len(CATEGORIES)]


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
    return Dishes(category, _lay_counter(category, generator), max(present, 1))


def _lay_counter(category: np.ndarray, generator: np.random.Generator) -> np.ndarray:
    """Draw upright poses on the counter, (n, 7), no two overlapping."""
    while True:
        poses = _try_to_lay(category, generator)
        if poses is not None:
            return poses


def _try_to_lay(category: np.ndarray, generator: np.random.Generator) -> np.ndarray | None:
    poses = np.zeros((len(category), 7), dtype=np.float32)
    extents = np.array([layout.EXTENTS[CATEGORIES[c]] for c in category])  # (n, 3)
    radius = np.hypot(extents[:, 0], extents[:, 1]) / 2 + DISH_GAP / 2
    laid: list[tuple[np.ndarray, np.ndarray, float]] = []  # corners, centre, radius
    for dish in np.argsort(-radius, kind="stable"):  # the largest first: they find room
        half = extents[dish, :2] / 2 + DISH_GAP / 2
        for _ in range(TRIES_PER_DISH):
            centre, yaw = _random_spot(half, generator)
            corners = _corners(centre, half, yaw)
            if not any(
                np.hypot(*(centre - other)) < radius[dish] + reach and _overlap(corners, outline)
                for outline, other, reach in laid
            ):
                break
        else:
            return None
        laid.append((corners, centre, radius[dish]))
        height = layout.COUNTER_HEIGHT + extents[dish, 2] / 2
        pose = (*centre, height, np.cos(yaw / 2), 0, 0, np.sin(yaw / 2))
        poses[dish] = np.round(pose, POSE_DECIMALS)
    return poses


def _random_spot(half: np.ndarray, generator: np.random.Generator) -> tuple[np.ndarray, float]:
    """A centre, (2,), and a yaw for a dish beside the sink, inside the counter's edges."""
    yaw = generator.uniform(-np.pi, np.pi)
    reach_x = abs(np.cos(yaw)) * half[0] + abs(np.sin(yaw)) * half[1] + COUNTER_MARGIN
    reach_y = abs(np.sin(yaw)) * half[0] + abs(np.cos(yaw)) * half[1] + COUNTER_MARGIN
    left, right = layout.COUNTER_X
    sink_left, sink_right = (layout.SINK_CENTRE[0] + s * layout.SINK_SIZE[0] / 2 for s in (-1, 1))
    room_left = sink_left - left - 2 * reach_x
    room_right = right - sink_right - 2 * reach_x
    x = generator.uniform(0, room_left + room_right)
    x += left + reach_x if x < room_left else sink_right + reach_x - room_left
    y = generator.uniform(layout.COUNTER_Y[0] + reach_y, layout.COUNTER_Y[1] - reach_y)
    return np.array([x, y]), yaw


def _corners(centre: np.ndarray, half: np.ndarray, yaw: float) -> np.ndarray:
    """The corners of a turned rectangle, (4, 2)."""
    across = half[0] * np.array([np.cos(yaw), np.sin(yaw)])
    along = half[1] * np.array([-np.sin(yaw), np.cos(yaw)])
    return centre + np.array([across + along, across - along, -across - along, along - across])


def _overlap(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two rectangles, (4, 2) each, overlap, by the separating axis theorem."""
    axes = np.array([a[0] - a[1], a[1] - a[2], b[0] - b[1], b[1] - b[2]])  # (4, 2)
    on_a, on_b = axes @ a.T, axes @ b.T  # (4, 4)
    return bool(((on_a.max(1) > on_b.min(1)) & (on_b.max(1) > on_a.min(1))).all())

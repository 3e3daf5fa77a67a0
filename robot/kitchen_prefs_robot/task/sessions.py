"""Session i of a split of the drawers: its preference, its dishes and its prompt's session.

A session is a pure function of (split, i, role). Its prompt is a session of the same preference
with other dishes of the same categories in other places.
"""

from dataclasses import dataclass, replace
from typing import Literal
from zlib import crc32

import numpy as np

from kitchen_prefs.simulation.counter_layout import lay_counter
from kitchen_prefs.simulation.layout import EXTENTS
from kitchen_prefs.utils.suggestions import suggest
from kitchen_prefs_robot.task.preferences import LABELS, PREFERENCES, DrawerPreference
from kitchen_prefs_robot.task.state import DrawersState, SeenDish

DATA_VERSION = 1  # a change that alters one session raises it
# How many dishes the sessions of a split have, in turn. Four is the paper's scene on hardware; more
# in training, so that what is learned does not depend on how long an episode lasts.
DISHES = {"train": (4, 5, 6, 7, 8), "val": (4,), "test": (4,)}

Role = Literal["situation", "prompt"]


@dataclass(frozen=True)
class DrawersSession:
    """One session.

    Attributes:
        split: "train", "val" or "test".
        index: Its number in the split.
        role: Whether it is a situation or what prompts the situation of the same number.
        label: The number of the preference in `preferences.PREFERENCES`.
        preference: The user's preference.
        start: The state at the start: all dishes on the table, both drawers closed.
    """

    split: str
    index: int
    role: Role
    label: int
    preference: DrawerPreference
    start: DrawersState

    def generator(self, purpose: str) -> np.random.Generator:
        """A fresh generator for one purpose, the same in every process."""
        return _generator(self.split, self.index, self.role, purpose)


def make_session(split: str, index: int, role: Role = "situation") -> DrawersSession:
    """Make one session; the preferences of the split take turns.

    Args:
        split: "train", "val" or "test", which have no partition of categories in common.
        index: Its number, from 0; there is no last one.
        role: Whether it is the situation or its prompt.

    Raises:
        ValueError: If there is no such split.
    """
    if split not in LABELS:
        raise ValueError(f"There is no split {split!r} of the drawers. {suggest(split, LABELS)}")
    turn, number = divmod(index, len(LABELS[split]))
    label = LABELS[split][number]
    preference = PREFERENCES[label]
    generator = _generator(split, index, role, "dishes")
    names = _draw_categories(preference, DISHES[split][turn % len(DISHES[split])], generator)
    return DrawersSession(split, index, role, label, preference, _lay(names, generator))


def prompt_session(session: DrawersSession, opposite: bool = False) -> DrawersSession:
    """The session whose demonstration is a session's prompt.

    Args:
        session: The situation.
        opposite: Whether the demonstration shows the opposite preference, each category in the
            other drawer: the control that tells whether a policy reads its prompt.
    """
    prompt = make_session(session.split, session.index, "prompt")
    return replace(prompt, preference=prompt.preference.opposite()) if opposite else prompt


def _generator(split: str, index: int, role: Role, purpose: str) -> np.random.Generator:
    names = (crc32(name.encode()) for name in (f"drawers {split}", role, purpose))
    return np.random.default_rng([DATA_VERSION, index, *names])


def _draw_categories(
    preference: DrawerPreference, dishes: int, generator: np.random.Generator
) -> list[str]:
    """The categories of the dishes: each of the preference's once, the others at random."""
    more = generator.choice(preference.categories, dishes - len(preference.categories))
    return generator.permutation([*preference.categories, *more]).tolist()


def _lay(names: list[str], generator: np.random.Generator) -> DrawersState:
    extents = np.array([EXTENTS[name] for name in names])  # (n, 3)
    dishes = (
        SeenDish(name, tuple(pose[:3]), tuple(pose[3:]), None)
        for name, pose in zip(names, lay_counter(extents, generator).tolist(), strict=True)
    )
    return DrawersState(tuple(dishes), opened=None, in_hand=None)

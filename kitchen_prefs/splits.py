"""The standard splits as named constants.

A split names the user of each session: 0..11 have the twelve preferences, 12 and above are the two
hundred others, whose preferences are drawn at random (see `simulation.sessions`).
"""

from dataclasses import dataclass

from kitchen_prefs.utils.suggestions import suggest

# A change that alters one byte of a data set or one session raises this version.
DATA_VERSION = 1

SEEN_USERS = tuple(range(7))
HELD_OUT_USERS = tuple(range(7, 12))
OTHER_USERS = tuple(range(12, 212))


@dataclass(frozen=True)
class Split:
    """A named set of sessions.

    Attributes:
        name: As in `dishwasher-<name>-v1`.
        users: The user of each session; its length is the split's size.
        counts: The numbers of dishes per rack that the sessions take in turn.
        purpose: What it is for, in a few words.
        serves_prompts: Whether its sessions serve as prompts: then each puts every category into a
            rack.
        noisy: Whether extents, poses and picks are noisy, as perception and grasping are.
        incomplete: Whether each session lacks one category, another one than its prompt lacks.
    """

    name: str
    users: tuple[int, ...]
    counts: tuple[int, ...]
    purpose: str
    serves_prompts: bool = False
    noisy: bool = False
    incomplete: bool = False

    @property
    def sessions(self) -> int:
        """How many sessions there are."""
        return len(self.users)

    @property
    def tasks(self) -> dict[int, tuple[int, ...]]:
        """The sessions of each of the twelve preferences, by its label; 12: those of all others."""
        labels = [min(user, OTHER_USERS[0]) for user in self.users]
        return {
            label: tuple(session for session, own in enumerate(labels) if own == label)
            for label in sorted(set(labels))
        }

    def count(self, index: int) -> int:
        """How many dishes per rack session `index` wants."""
        return self.counts[index % len(self.counts)]


def _each(users: tuple[int, ...], sessions: int) -> tuple[int, ...]:
    return tuple(user for user in users for _ in range(sessions))


TRAINING_COUNTS = (6, 7)  # the paper's
OTHER_COUNTS = (3, 4, 5, 8, 9, 10)

SPLITS = {
    split.name: split
    for split in (
        Split("train", _each(SEEN_USERS, 80), TRAINING_COUNTS, "training", serves_prompts=True),
        Split("val", _each(SEEN_USERS, 10), TRAINING_COUNTS, "choosing a checkpoint"),
        Split("seen", _each(SEEN_USERS, 10), TRAINING_COUNTS, "test"),
        Split("unseen_preferences", _each(HELD_OUT_USERS, 20), TRAINING_COUNTS, "test"),
        Split("unseen_counts", _each(SEEN_USERS, 30), OTHER_COUNTS, "test"),
        Split("unseen_both", _each(HELD_OUT_USERS, 30), OTHER_COUNTS, "test"),
        Split("many_preferences", OTHER_USERS, TRAINING_COUNTS, "test"),
        Split("noisy", _each(SEEN_USERS + HELD_OUT_USERS, 5), TRAINING_COUNTS, "test", noisy=True),
        Split(
            "prompts",
            _each(HELD_OUT_USERS, 80) + OTHER_USERS,
            TRAINING_COUNTS,
            "prompts of preferences that training does not see",
            serves_prompts=True,
        ),
        Split(
            "incomplete_prompts",
            _each(SEEN_USERS + HELD_OUT_USERS, 5),
            TRAINING_COUNTS,
            "diagnosis: prompts that lack a category",
            incomplete=True,
        ),
    )
}
TEST_SPLITS = (
    "seen",
    "unseen_preferences",
    "unseen_counts",
    "unseen_both",
    "many_preferences",
    "noisy",
)


def get_split(name: str) -> Split:
    """The split with a given name.

    Raises:
        ValueError: If there is none; the message suggests the nearest.
    """
    if name not in SPLITS:
        raise ValueError(f"There is no split {name!r}. {suggest(name, SPLITS)}")
    return SPLITS[name]

"""The ten splits of the second tier as named constants; their users are disjoint."""

from dataclasses import dataclass

from kitchen_prefs.utils.suggestions import suggest

# A change that alters one byte of a data set or one session of the second tier raises it.
PEOPLE_DATA_VERSION = 2

COUNTS = (16, 17, 18)  # of dishes, in turn
# A prompt of two demonstrations is of two users, and it is said whose evening it is; one of one or
# of three is of one user.
PROMPTS_OF_TWO_USERS = 2
SLIPS = 0.1  # the share of dishes that an inconsistent user puts elsewhere


@dataclass(frozen=True)
class PeopleSplit:
    """A named set of sessions.

    Attributes:
        name: As in `dishwasher-<name>-v2`.
        users: How many users there are.
        purpose: What it asks, in a few words.
        sessions_each: How many sessions each user has.
        prompts: How many demonstrations prompt an episode.
        counts: The numbers of dishes that the sessions take in turn.
        certified: Whether a prompt tells enough of its session, see `certificates`.
        composed: Whether users have pairs of rules that those of other splits lack.
        lacking: How many categories the prompts lack.
        slips: The share of dishes of a prompt that the user puts elsewhere by mistake.
        polled: Whether the users' zones are those that polls tell of.
        evening: Whether two users' demonstrations prompt, and it is said whose evening it is.
    """

    name: str
    users: int
    purpose: str
    sessions_each: int = 1
    prompts: int = 1
    counts: tuple[int, ...] = COUNTS
    certified: bool = True
    composed: bool = False
    lacking: int = 0
    slips: float = 0.0
    polled: bool = False
    evening: bool = False

    @property
    def sessions(self) -> int:
        """How many sessions there are."""
        return self.users * self.sessions_each

    def user(self, session: int) -> int:
        """The number of a session's user within the split."""
        return session // self.sessions_each

    def count(self, session: int) -> int:
        """How many dishes a session has."""
        return self.counts[session % len(self.counts)]


PEOPLE_SPLITS = {
    split.name: split
    for split in (
        PeopleSplit("people_train", 2000, "training", sessions_each=2, certified=False),
        PeopleSplit("people_val", 100, "choosing a checkpoint"),
        PeopleSplit("people_unseen", 200, "new users of the same kinds"),
        PeopleSplit("people_composed", 200, "pairs of rules that training lacks", composed=True),
        PeopleSplit("people_three", 200, "three prompts", prompts=3),
        PeopleSplit(
            "people_partial", 200, "prompts that lack two categories", certified=False, lacking=2
        ),
        PeopleSplit(
            "people_inconsistent",
            200,
            "slips in three prompts",
            prompts=3,
            certified=False,
            slips=SLIPS,
        ),
        PeopleSplit("people_overflow", 200, "what happens when it is full", counts=(24,)),
        PeopleSplit("people_polls", 200, "zones as polls tell of real homes", polled=True),
        PeopleSplit(
            "people_evening",
            200,
            "whose evening it is, of two users",
            prompts=PROMPTS_OF_TWO_USERS,
            evening=True,
        ),
    )
}
PEOPLE_TEST_SPLITS = tuple(PEOPLE_SPLITS)[2:]


def get_people_split(name: str) -> PeopleSplit:
    """The split with a given name.

    Raises:
        ValueError: If there is none; the message suggests the nearest.
    """
    if name not in PEOPLE_SPLITS:
        raise ValueError(f"There is no split {name!r}. {suggest(name, PEOPLE_SPLITS)}")
    return PEOPLE_SPLITS[name]

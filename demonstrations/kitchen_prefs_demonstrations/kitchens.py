"""The kitchens that the page shows.

They are sessions of the split `prompts` whose users are the two hundred others, so each belongs to
another user whose preference was drawn at random from all 2 x 7!: what stands on the counter tells
of that user, and nothing of the visitor. Each has every category, and no session of a test split is
ever a prompt.
"""

from collections.abc import Sequence

from kitchen_prefs.simulation.sessions import Session, make_session
from kitchen_prefs.splits import OTHER_USERS, get_split

SPLIT = "prompts"
# A study's kitchen is one for everybody, because only demonstrations with the same dishes compare
# dish by dish. Session 3 is the first of its split with 16 dishes; the session seed is a fresh one,
# because those of 0 are the published test.
STUDY_SPLIT, STUDY_SESSION, STUDY_SALT = "unseen_both", 3, 1


def page_indices() -> Sequence[int]:
    """The sessions' indices in `prompts`."""
    return [i for i, user in enumerate(get_split(SPLIT).users) if user in OTHER_USERS]


def page_sessions(count: int, salt: int = 0) -> list[Session]:
    """The first sessions that the page shows, 12 and 14 dishes in turn.

    Args:
        count: How many, at most 200.
        salt: The session seed; 0 gives the published ones.
    """
    return [make_session(SPLIT, index, salt) for index in page_indices()[:count]]


def study_session() -> Session:
    """The kitchen of studies, 16 dishes."""
    return make_session(STUDY_SPLIT, STUDY_SESSION, STUDY_SALT)

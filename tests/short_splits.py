"""Cuts the splits of evaluations down to six sessions, so that whole submissions take seconds.

`short_splits_of_programs/sitecustomize.py`, on the PYTHONPATH of a program that a test starts, does
the same there: no command has an option for it, as scores of a shorter split would not compare.
"""

from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.people.splits import PEOPLE_SPLITS, PEOPLE_TEST_SPLITS
from kitchen_prefs.splits import SPLITS, TEST_SPLITS

SESSIONS = 6
OF_PROGRAMS = Path(__file__).parent / "short_splits_of_programs"


@contextmanager
def short_splits(sessions=SESSIONS):
    """Cut the splits down for as long as it lasts, for the programs that are started, too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(OF_PROGRAMS))
        patch.setenv("SESSIONS_OF_SHORT_SPLITS", str(sessions))
        for name in ("val", *TEST_SPLITS):
            split = SPLITS[name]
            patch.setitem(SPLITS, name, replace(split, users=split.users[:sessions]))
        with short_people_splits(sessions):
            yield


@contextmanager
def short_people_splits(sessions):
    """Cut the splits of the second tier down, without certificates, which take a second each."""
    make_people_session.cache_clear()
    with pytest.MonkeyPatch.context() as patch:
        for name in ("people_val", *PEOPLE_TEST_SPLITS):
            short = replace(PEOPLE_SPLITS[name], users=sessions, certified=False)
            patch.setitem(PEOPLE_SPLITS, name, short)
        yield
    make_people_session.cache_clear()

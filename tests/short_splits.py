"""Cuts the test splits down to six sessions, so that whole submissions take seconds.

`short_splits_of_programs/sitecustomize.py`, on the PYTHONPATH of a program that a test starts, does
the same there: no command has an option for it, as scores of a shorter split would not compare.
"""

from contextlib import contextmanager
from dataclasses import replace

import pytest

from kitchen_prefs.splits import SPLITS, TEST_SPLITS

SESSIONS = 6


@contextmanager
def short_splits():
    """Cut the test splits down for as long as it lasts."""
    with pytest.MonkeyPatch.context() as patch:
        for name in TEST_SPLITS:
            split = SPLITS[name]
            patch.setitem(SPLITS, name, replace(split, users=split.users[:SESSIONS]))
        yield

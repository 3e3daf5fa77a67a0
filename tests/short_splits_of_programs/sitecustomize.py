"""On PYTHONPATH, lets a program and all programs that it starts know few sessions a split."""

import os
from dataclasses import replace

from kitchen_prefs.people.splits import PEOPLE_SPLITS, PEOPLE_TEST_SPLITS
from kitchen_prefs.splits import SPLITS, TEST_SPLITS

SESSIONS = int(os.environ.get("SESSIONS_OF_SHORT_SPLITS", "6"))

SPLITS.update(
    {
        name: replace(SPLITS[name], users=SPLITS[name].users[:SESSIONS])
        for name in ("val", *TEST_SPLITS)
    }
)
PEOPLE_SPLITS.update(
    {
        name: replace(PEOPLE_SPLITS[name], users=SESSIONS, certified=False)
        for name in ("people_val", *PEOPLE_TEST_SPLITS)
    }
)

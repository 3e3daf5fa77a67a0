"""Short splits for tests of evaluation."""

from dataclasses import replace

import pytest

from kitchen_prefs import splits


@pytest.fixture
def few_sessions(monkeypatch):
    """Cut the splits that these tests roll out down to their first five sessions."""
    for name in ("val", "seen", "noisy"):
        split = splits.SPLITS[name]
        monkeypatch.setitem(splits.SPLITS, name, replace(split, users=split.users[:5]))

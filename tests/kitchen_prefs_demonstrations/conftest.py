"""Demonstrations by the expert, as the page would give them."""

import json

import pytest
from simulated_users import NUMBERS, content_of

from kitchen_prefs.preferences import preference_from_number
from kitchen_prefs_demonstrations.kitchens import page_sessions
from kitchen_prefs_demonstrations.replaying import read_and_replay


@pytest.fixture(scope="session")
def content():
    """A demonstration by the expert, as the page gives it."""
    return content_of(page_sessions(1)[0], preference_from_number(NUMBERS[0]))


@pytest.fixture
def read(tmp_path):
    """Writes a file, and reads and replays it."""

    def read(content):
        file = tmp_path / "demonstration.json"
        file.write_bytes(content if isinstance(content, bytes) else json.dumps(content).encode())
        return read_and_replay(file)

    return read

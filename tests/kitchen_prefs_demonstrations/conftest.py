"""Demonstrations by the expert, as the page would give them."""

import json

import pytest

from kitchen_prefs.preferences import preference_from_number
from kitchen_prefs.simulation.expert import roll_out_expert
from kitchen_prefs.simulation.kitchen import Kitchen
from kitchen_prefs_demonstrations.kitchens import page_sessions
from kitchen_prefs_demonstrations.replaying import read_and_replay

# Ten preferences, spread over all 2 x 7!; none is one of the twelve.
NUMBERS = tuple(range(500, 10_080, 1_000))


def content_of(session, preference, **changes):
    """The content of the file of a demonstration by the expert of a preference."""
    decisions = list(roll_out_expert(Kitchen(session.dishes), preference).decisions)
    start = {"split": session.split, "session": session.index, "salt": session.salt}
    person = {"user": "Ada", "consent": True, "study": None}
    return {"format": 1, "data_version": 1} | start | {"decisions": decisions} | person | changes


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

"""A submission whose every action is the expert's."""

import bz2

import pytest

from kitchen_prefs import instances
from kitchen_prefs.play import Play
from kitchen_prefs.sessions import expert_run, make_session
from kitchen_prefs.splits import TEST_SPLITS, get_split
from kitchen_prefs_leaderboard.replay import to_jsonl, write_line
from kitchen_prefs_leaderboard.submission import ACTIONS, DESCRIPTION, Actor
from kitchen_prefs_leaderboard.submitting import describe


def played_by_the_expert(split, index):
    """The expert's episode of a session; where a grasp fails, it tries again."""
    play = Play(make_session(split, index))
    for instance in expert_run(play.session).decisions:
        refusal = "not yet"
        while refusal:
            row = play.seen.row_of(instance)
            refusal = play.decide(instance, play.seen.rows[row, instances.POSE])
    return play.episode()


def description(**about):
    """What an honest submission says of itself."""
    usual = {
        "name": "The expert",
        "authors": ["A. Person"],
        "track": "privileged",
        "policy": Actor(type="expert"),
        "hardware": "none",
        "training": "none",
    }
    return describe(**(usual | about))


@pytest.fixture(scope="session")
def expert_files():
    """The files of an honest submission, by name."""
    files = {}
    for split in TEST_SPLITS:
        sessions = range(get_split(split).sessions)
        lines = [write_line(played_by_the_expert(split, index)) for index in sessions]
        files[ACTIONS[split]] = bz2.compress(to_jsonl(lines))
    files[DESCRIPTION] = description().model_dump_json().encode()
    return files


@pytest.fixture
def submission(expert_files, tmp_path):
    """A folder with an honest submission, to be tampered with."""
    folder = tmp_path / "submission"
    folder.mkdir()
    for name, content in expert_files.items():
        (folder / name).write_bytes(content)
    return folder

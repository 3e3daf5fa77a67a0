"""Submissions and entries whose every action is the expert's, whole ones and small ones."""

import bz2
import sys
from dataclasses import replace
from shutil import copytree

import pytest
from short_splits import SESSIONS

from kitchen_prefs import instances
from kitchen_prefs.cli import main
from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs.splits import TEST_SPLITS, get_split
from kitchen_prefs_leaderboard.replay import to_jsonl, write_line
from kitchen_prefs_leaderboard.scoring import Entry
from kitchen_prefs_leaderboard.submission_format import ACTIONS, DESCRIPTION, Policy
from kitchen_prefs_leaderboard.submission_writing import describe


def played_by_the_expert(split, index):
    """The expert's episode of a session; where a grasp fails, it tries again."""
    simulator = EpisodeSimulator(make_session(split, index))
    for instance in expert_trajectory(simulator.session).decisions:
        refusal = "not yet"
        while refusal:
            row = simulator.observation.row_of(instance)
            refusal = simulator.decide(instance, simulator.observation.rows[row, instances.POSE])
    return simulator.episode()


def description(**about):
    """What an honest submission says of itself."""
    usual = {
        "name": "The expert",
        "authors": ["A. Author"],
        "track": "privileged",
        "policy": Policy(type="expert", checkpoint="e" * 64),
        "hardware": "none",
        "training": "none",
    }
    return describe(**(usual | about))


@pytest.fixture(scope="session")
def expert_submission(made_once):
    """The folder of an honest submission, made once a run; it must stay as it is."""

    def fill(folder):
        for split in TEST_SPLITS:
            sessions = range(get_split(split).sessions)
            lines = [write_line(played_by_the_expert(split, index)) for index in sessions]
            (folder / ACTIONS[split]).write_bytes(bz2.compress(to_jsonl(lines)))
        (folder / DESCRIPTION).write_text(description().model_dump_json())

    return made_once("expert_submission", fill)


@pytest.fixture
def submission(expert_submission, tmp_path):
    """A copy of the honest submission, to be tampered with."""
    return copytree(expert_submission, tmp_path / "submission")


@pytest.fixture(scope="session")
def perfect():
    """The expert's episodes of the first six sessions of each test split."""
    return {
        split: [played_by_the_expert(split, index) for index in range(SESSIONS)]
        for split in TEST_SPLITS
    }


@pytest.fixture(scope="session")
def few_episodes(perfect):
    """Gives the expert's episodes, of which some on the split `seen` pack nothing."""

    def spoilt(e):
        return replace(e, placed=(0, 0), decisions=e.decisions[::-1], kinds=e.kinds[::-1])

    def give(worse=(), salt=0):
        seen = [spoilt(e) if e.session in worse else e for e in perfect["seen"]]
        return {
            split: [replace(episode, salt=salt) for episode in episodes]
            for split, episodes in (perfect | {"seen": seen}).items()
        }

    return give


@pytest.fixture(scope="session")
def make_entry(few_episodes):
    """Makes an entry of those episodes; its digest is one letter, repeated."""

    def make(letter, worse=(), **about):
        return Entry(description(name=letter, **about), letter * 64, few_episodes(worse))

    return make


@pytest.fixture
def kitchen_prefs(monkeypatch):
    """Runs a command in this process; gives its exit code, or what it says went wrong."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["kitchen-prefs", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            main()
        return stopped.value.code

    return run

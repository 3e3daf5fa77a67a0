"""Submissions and entries whose every action is the expert's, whole ones and small ones."""

import bz2
import runpy
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from kitchen_prefs import instances
from kitchen_prefs.cli import main
from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs.splits import SPLITS, TEST_SPLITS, get_split
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
            row = simulator.seen.row_of(instance)
            refusal = simulator.decide(instance, simulator.seen.rows[row, instances.POSE])
    return simulator.episode()


def description(**about):
    """What an honest submission says of itself."""
    usual = {
        "name": "The expert",
        "authors": ["A. Person"],
        "track": "privileged",
        "policy": Policy(type="expert", checkpoint="e" * 64),
        "hardware": "none",
        "training": "none",
    }
    return describe(**(usual | about))


@pytest.fixture(scope="session")
def expert_files():
    """The files of an honest submission, by name."""
    assert get_split("seen").sessions == 70, "few_sessions was asked for before"
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


@pytest.fixture(scope="module")
def few_sessions():
    """Cuts the test splits down to six sessions; the folder does the same to other programs."""
    folder = Path(__file__).with_name("few_sessions")
    whole = dict(SPLITS)
    runpy.run_path(str(folder / "sitecustomize.py"))
    yield folder
    SPLITS.update(whole)


@pytest.fixture(scope="module")
def few_episodes(few_sessions):
    """Gives the expert's episodes, of which some on the split `seen` pack nothing."""
    perfect = {
        split: [played_by_the_expert(split, i) for i in range(get_split(split).sessions)]
        for split in TEST_SPLITS
    }

    def give(worse=(), salt=0):
        seen = [replace(e, placed=(0, 0)) if e.session in worse else e for e in perfect["seen"]]
        return {
            split: [replace(episode, salt=salt) for episode in episodes]
            for split, episodes in (perfect | {"seen": seen}).items()
        }

    return give


@pytest.fixture(scope="module")
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

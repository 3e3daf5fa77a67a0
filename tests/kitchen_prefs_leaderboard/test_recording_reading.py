"""Submissions from what lerobot-eval records."""

import os
from shutil import copytree, rmtree

import pytest
import warm_python
from short_splits import short_splits

from kitchen_prefs.splits import TEST_SPLITS
from kitchen_prefs_leaderboard.recording_reading import read_recordings
from kitchen_prefs_leaderboard.scoring import score_submissions

SYMBOLIC = ("--policy.type=rules", "--policy.rule=symbolic")
# One process for all splits, because LeRobot takes seconds to start.
RECORD_ALL = f"""
import sys

from lerobot.scripts.lerobot_eval import main

for split in {TEST_SPLITS!r}:
    sys.argv[1:] = [
        *{SYMBOLIC!r},
        "--env.type=kitchen_prefs",
        f"--env.task={{split}}",
        "--eval.n_episodes=6",
        "--eval.batch_size=6",
        "--eval.recording=true",
        f"--output_dir={{split}}",
    ]
    main()
"""

pytestmark = [
    pytest.mark.xdist_group("recordings"),
    pytest.mark.lerobot,
    pytest.mark.slow,
    pytest.mark.usefixtures("few_sessions"),
]


@pytest.fixture(scope="session")
def recordings(made_once):
    def fill(folder):
        with short_splits():
            environment = os.environ | {"HF_HUB_OFFLINE": "1"}
            done = warm_python.run("-c", RECORD_ALL, cwd=folder, env=environment)
        assert done.returncode == 0, done.stderr[-3000:]

    return made_once("recordings", fill)


def test_recordings_are_the_submission_that_rolling_out_makes(recordings, tmp_path, kitchen_prefs):
    submit = ("leaderboard", "submit", "--name=Symbolic", "--track=standard", *SYMBOLIC)
    recorded, rolled_out = tmp_path / "recorded", tmp_path / "rolled_out"
    assert not kitchen_prefs(*submit, f"--out={recorded}", f"--from={recordings}")
    assert not kitchen_prefs(*submit, f"--out={rolled_out}", "--jobs=1")
    for file in sorted(rolled_out.glob("*.bz2")):
        assert (recorded / file.name).read_bytes() == file.read_bytes()
    (entry,) = score_submissions([recorded], jobs=1)
    assert entry.metrics["seen"]["PE"].mean > 0.9


def test_a_session_or_a_split_that_is_not_recorded_is_named(recordings, tmp_path):
    copy = copytree(recordings, tmp_path / "copy")
    rmtree(copy / "seen/recordings/kitchen_prefs_0/env_0")
    with pytest.raises(ValueError, match=r"seen.recordings lacks session \d of seen; run"):
        read_recordings(copy, TEST_SPLITS)
    file = next((copy / "seen/recordings").rglob("data/*/*.parquet"))
    file.write_bytes(file.read_bytes()[:500])
    with pytest.raises(ValueError, match="is no recording of this environment"):
        read_recordings(copy, TEST_SPLITS)
    rmtree(copy / "noisy/recordings")
    with pytest.raises(ValueError, match="noisy has no recordings"):
        read_recordings(copy, TEST_SPLITS)


def test_recordings_of_another_split_are_refused(recordings, tmp_path):
    copy = copytree(recordings, tmp_path / "copy")
    rmtree(copy / "seen")
    copytree(recordings / "unseen_counts", copy / "seen")
    with pytest.raises(ValueError, match="holds an episode of no session of seen"):
        read_recordings(copy, TEST_SPLITS)

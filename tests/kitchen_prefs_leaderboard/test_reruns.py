"""Re-runs of policies that are nobody's friends, through the command."""

import sys
from pathlib import Path

import pytest

from kitchen_prefs.simulation.sessions import FRESH_USERS, PUBLISHED_USERS, make_session
from kitchen_prefs.splits import HELD_OUT_USERS, SEEN_USERS, SPLITS
from kitchen_prefs_leaderboard.rerun_plan import Run, fresh_run
from kitchen_prefs_leaderboard.reruns import Rerunner, rerun_submission
from kitchen_prefs_leaderboard.submission_writing import describe, policy_of, write_submission
from kitchen_prefs_leaderboard.verification import Verification, read_verifications

ATTACKERS = Path(__file__).parents[1] / "attackers"


@pytest.mark.lerobot
@pytest.mark.slow
@pytest.mark.usefixtures("few_sessions")
def test_a_policy_that_reads_its_neighbours_in_the_batch_is_not_confirmed(
    kitchen_prefs, tmp_path, capsys
):
    options = ["--attack=neighbours"]
    settings = {"policy_type": "attackers", "options": options, "track": "standard"}
    rerunner = Rerunner(settings, tmp_path / "own", jobs=1, plugins=ATTACKERS)
    submission = describe(
        name="Neighbours",
        authors=["A. Attacker"],
        track="standard",
        policy=policy_of(rerunner.described, ATTACKERS),
        hardware="none",
        training="none",
    )
    episodes = rerunner.roll_out([Run("published-1", 0)])["published-1"]
    write_submission(submission, episodes, tmp_path / "submission")
    policy = ("--policy.type=attackers", "--policy.attack=neighbours")
    folders = (f"--verifications={tmp_path / 'records'}", f"--out={tmp_path / 'out'}")
    rerun = (
        "leaderboard",
        "verify",
        tmp_path / "submission",
        "--rerun",
        "--jobs=1",
        f"--plugins={ATTACKERS}",
    )
    assert kitchen_prefs(*rerun, *policy, *folders, "--by=A. Maintainer") == 1
    assert "its episodes depend on each other" in capsys.readouterr().out
    (record,) = (tmp_path / "records").glob("*.json")
    found = Verification.model_validate_json(record.read_text())
    assert (found.repeats, found.independent, found.by) == (True, False, "A. Maintainer")
    assert read_verifications(tmp_path / "records") == {}
    assert "lerobot_policy_attackers" not in sys.modules  # its code has run elsewhere


def test_fresh_sessions_are_of_fresh_users(tmp_path):
    run = fresh_run(tmp_path, "standard", None)
    assert run.salt >= FRESH_USERS
    published = {make_session("unseen_preferences", i).preference for i in range(100)}
    for split in ("unseen_preferences", "unseen_both", "noisy", "prompts"):
        for i in range(0, SPLITS[split].sessions, 7):
            session, known = make_session(split, i, run.salt), make_session(split, i)
            if session.user in HELD_OUT_USERS:
                assert session.preference not in published
            if session.user in SEEN_USERS:
                assert session.preference == known.preference


def test_fresh_sessions_of_a_track_with_labels_keep_the_twelve(tmp_path):
    run = fresh_run(tmp_path, "privileged", None)
    assert run.salt >= PUBLISHED_USERS
    session = make_session("unseen_preferences", 3, run.salt)
    assert session.preference == make_session("unseen_preferences", 3).preference


@pytest.mark.parametrize("track", ["standard", "privileged"])
def test_fresh_sessions_cannot_be_found_by_trying(tmp_path, track):
    salts = {fresh_run(tmp_path, track, None).salt for _ in range(8)}
    assert len(salts) == 8
    assert 2**40 < max(salts) < 2**53


def test_a_rerun_that_was_begun_goes_on_with_its_seed(tmp_path):
    run = fresh_run(tmp_path, "standard", None)
    (tmp_path / run.name).mkdir()
    assert fresh_run(tmp_path, "standard", None) == run
    assert fresh_run(tmp_path, "standard", 5).salt == 5


class RecordedRuns:
    """In place of a `Rerunner`: notes what it is to roll out; each run fails in other sessions."""

    def __init__(self, folder, episodes, worse):
        self.folder, self.episodes, self.worse, self.runs = folder, episodes, iter(worse), []

    def roll_out(self, runs):
        self.runs += runs
        return {
            run.name: self.episodes([] if run.salt else next(self.worse), run.salt) for run in runs
        }


def test_a_policy_that_does_not_repeat_itself_is_rolled_out_again_in_batches_and_alone(
    make_entry, few_episodes, tmp_path
):
    rerunner = RecordedRuns(tmp_path, few_episodes, ([0, 1], [2, 3], [4, 5]))
    found = rerun_submission(make_entry("a", worse=[2]), rerunner, 7, "A. Maintainer")
    published = [run for run in rerunner.runs if run.name.startswith("published")]
    assert [run.batch_size for run in published] == [16, 16, 1]
    assert found.runs == 3
    assert found.itself < 0.95


def test_episodes_rolled_out_alone_are_fresh_ones_that_the_seed_chooses(
    make_entry, few_episodes, tmp_path
):
    chosen = set()
    for salt in (7, 8, 9):
        rerunner = RecordedRuns(tmp_path, few_episodes, ([],))
        rerun_submission(make_entry("a"), rerunner, salt, "A. Maintainer")
        (alone,) = (run for run in rerunner.runs if run.few)
        assert (alone.salt, alone.batch_size) == (salt, 1)
        chosen.add(tuple(alone.sessions("seen")))
    assert len(chosen) == 3

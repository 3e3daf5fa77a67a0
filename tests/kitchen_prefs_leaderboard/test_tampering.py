"""What a scorer refuses: whatever was changed, and what it says of it."""

import bz2
import json

import pytest

from kitchen_prefs_leaderboard.replay import replay_split
from kitchen_prefs_leaderboard.scoring import read_known, score_submissions
from kitchen_prefs_leaderboard.submission_reading import read_submission

SEEN = "seen.jsonl.bz2"

pytestmark = pytest.mark.slow  # a whole submission is made


def lines_of(folder):
    return bz2.decompress((folder / SEEN).read_bytes()).splitlines()


def write(folder, lines):
    (folder / SEEN).write_bytes(bz2.compress(b"\n".join(lines) + b"\n"))


def edited(line, **changes):
    return json.dumps(json.loads(line) | changes).encode()


def refused(folder, message):
    with pytest.raises(ValueError, match=message) as error:
        replay_split(read_submission(folder), "seen")
    assert "\n" not in str(error.value)
    return str(error.value)


def test_an_honest_submission_is_the_expert(submission):
    (entry,) = score_submissions([submission], 1)
    for split, metrics in entry.metrics.items():
        assert metrics["PE"].mean == 1
        assert metrics["Score"].mean == (
            1 if split not in ("noisy", "mean") else pytest.approx(1, abs=0.02)
        )


def test_the_same_files_give_the_same_entry(submission):
    first, second = (score_submissions([submission], 1)[0] for _ in range(2))
    assert first == second


def test_actions_of_another_session(submission):
    lines = lines_of(submission)
    lines[0] = edited(lines[1], session=0)
    write(submission, lines)
    refused(submission, "line 1: session 0 of seen begins in another state")


def test_reordered_lines(submission):
    lines = lines_of(submission)
    write(submission, [lines[1], lines[0], *lines[2:]])
    refused(submission, "line 1 is session 1; each session appears once")


def test_a_line_that_is_there_twice(submission):
    lines = lines_of(submission)
    write(submission, [lines[0], *lines])
    refused(submission, "line 2 is session 0")


def test_a_line_that_is_missing(submission):
    write(submission, lines_of(submission)[:-1])
    refused(submission, "has 69 episodes; seen has 70 sessions")


def test_a_line_that_is_cut_off(submission):
    lines = lines_of(submission)
    write(submission, [lines[0][:200], *lines[1:]])
    refused(submission, "line 1 does not follow the format")


@pytest.mark.parametrize("position", [5, 10, -2])
def test_an_action_that_was_changed(submission, position):
    lines = lines_of(submission)
    actions = json.loads(lines[3])["actions"]
    actions[position] = actions[position - 1]
    lines[3] = edited(lines[3], actions=actions)
    write(submission, lines)
    refused(submission, "line 4: the ")


def test_actions_after_the_end(submission):
    lines = lines_of(submission)
    actions = json.loads(lines[0])["actions"]
    lines[0] = edited(lines[0], actions=[*actions, actions[-1]])
    write(submission, lines)
    refused(submission, "line 1: the episode ends before action")


def test_an_end_that_is_left_out(submission):
    lines = lines_of(submission)
    lines[0] = edited(lines[0], actions=json.loads(lines[0])["actions"][:-1])
    write(submission, lines)
    refused(submission, "line 1: the episode continues after the last action")


def test_a_forbidden_decision_that_is_hidden(submission):
    """A failed grasp changes nothing in the kitchen, yet who leaves it out is found out."""
    file = submission / "noisy.jsonl.bz2"
    lines = bz2.decompress(file.read_bytes()).splitlines()
    episodes = replay_split(read_submission(submission), "noisy")
    number, failed = next((e.session, e.refused.index(True)) for e in episodes if any(e.refused))
    actions = json.loads(lines[number])["actions"]
    lines[number] = edited(lines[number], actions=actions[:failed] + actions[failed + 1 :])
    file.write_bytes(bz2.compress(b"\n".join(lines) + b"\n"))
    with pytest.raises(ValueError, match=f"line {number + 1}: "):
        replay_split(read_submission(submission), "noisy")


def test_another_version_of_the_data(submission):
    file = submission / "submission.json"
    file.write_text(json.dumps(json.loads(file.read_bytes()) | {"data_version": 2}))
    with pytest.raises(ValueError, match="is of data version 2"):
        read_known(submission)

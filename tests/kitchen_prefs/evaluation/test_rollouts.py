"""Rollouts: the sessions' order and batches, the file of an evaluation, and what is refused."""

import json
from dataclasses import replace
from typing import cast

import numpy as np
import pytest

from kitchen_prefs import splits
from kitchen_prefs.envs.demonstrations import demonstrate
from kitchen_prefs.evaluation.episode_files import EpisodeFile, EvaluationConditions, read_episodes
from kitchen_prefs.evaluation.evaluator import Evaluator
from kitchen_prefs.evaluation.policy_loading import LoadedPolicy
from kitchen_prefs.evaluation.rollouts import roll_out
from kitchen_prefs.instances import POSE, choosable
from kitchen_prefs.metrics import METRICS, category_accuracy
from kitchen_prefs.simulation.sessions import make_session

SESSIONS = (0, 13, 31, 50, 69)


class Lowest:
    """Chooses the lowest pose; deterministic, and blind to the order of rows."""

    fingerprint = "lowest"
    track = "standard"
    type = "lowest"

    def __init__(self) -> None:
        self.decisions = 0
        self.resets = 0

    def reset(self) -> None:
        self.resets += 1

    def act(self, observations, tasks):
        self.decisions += 1
        assert len(observations) == len(tasks)
        return np.stack([self.decide(seen["instances"]) for seen in observations])

    def decide(self, instances):
        poses = instances[choosable(instances), POSE]  # (c, 7)
        return poses[np.lexsort(poses.T)[0]]


class Imitator(Lowest):
    """Knows what the expert does in each state of some sessions."""

    def __init__(self, split, sessions) -> None:
        super().__init__()
        demonstrations = [demonstrate(make_session(split, session)) for session in sessions]
        self.known = {
            instances.tobytes(): action
            for demonstration in demonstrations
            for instances, action in zip(demonstration.instances, demonstration.action, strict=True)
        }

    def decide(self, instances):
        return self.known.get(instances.tobytes(), np.zeros(7, dtype=np.float32))


STANDARD = EvaluationConditions(
    policy="lowest",
    fingerprint="abc",
    track="standard",
    prompt_of="same",
    prompts=1,
    expert_states=False,
    salt=0,
    data_version=1,
    package_version="1",
)


def test_imitating_the_expert_is_perfect():
    for episode in roll_out(Imitator("seen", SESSIONS), "seen", sessions=SESSIONS, batch_size=2):
        assert {name: metric(episode) for name, metric in METRICS.items()} == dict.fromkeys(
            METRICS, 1
        )


@pytest.mark.parametrize("batch_size", [1, 2, 16])
def test_episodes_do_not_depend_on_the_batch_size(batch_size):
    expected = roll_out(Lowest(), "seen", sessions=SESSIONS, batch_size=3)
    assert roll_out(Lowest(), "seen", sessions=SESSIONS, batch_size=batch_size) == expected


def test_each_session_is_rolled_out_once_in_order():
    episodes = roll_out(Lowest(), "val", batch_size=32)
    assert [episode.session for episode in episodes] == list(range(70))
    assert {episode.split for episode in episodes} == {"val"}


def test_a_policy_is_reset_for_each_batch():
    policy = Lowest()
    roll_out(policy, "seen", sessions=SESSIONS, batch_size=2)
    assert policy.resets == 3


def test_another_salt_gives_other_episodes():
    published = roll_out(Lowest(), "seen", sessions=[0])
    fresh = roll_out(Lowest(), "seen", sessions=[0], salt=1)
    assert fresh[0].salt == 1
    assert fresh[0].actions != published[0].actions


@pytest.mark.parametrize("split", ["seen", "noisy"])
def test_in_the_experts_states_every_decision_is_compared(split):
    episodes = roll_out(Lowest(), split, sessions=(0, 5, 9), expert_states=True)
    for episode in episodes:
        assert len(episode.kinds) == len(episode.expert_kinds)
        assert 0 < category_accuracy(episode) < 1
        assert episode.finished
    imitator = Imitator("seen", [0])
    (episode,) = roll_out(imitator, "seen", sessions=[0], expert_states=True)
    assert category_accuracy(episode) == 1


def test_unknown_names_are_refused_with_the_nearest():
    with pytest.raises(ValueError, match="unseen_both"):
        roll_out(Lowest(), "unseen_bth")
    with pytest.raises(ValueError, match="privileged"):
        roll_out(Lowest(), "seen", sessions=[0], track="priviledged")
    with pytest.raises(ValueError, match=r"0\.\.69"):
        roll_out(Lowest(), "seen", sessions=[70])


# The file ---------------------------------------------------------------------------------------


def test_a_killed_evaluation_resumes(tmp_path):
    path = tmp_path / "seen.jsonl"
    whole = roll_out(
        Lowest(), "seen", sessions=SESSIONS, batch_size=2, file=EpisodeFile(path, STANDARD)
    )
    lines = path.read_text().splitlines(keepends=True)
    assert len(lines) == len(SESSIONS)
    path.write_text("".join(lines[:3]) + lines[3][:100])  # as a kill leaves it

    policy = Lowest()
    file = EpisodeFile(path, STANDARD)
    assert len(file.episodes) == 3
    resumed = roll_out(policy, "seen", sessions=SESSIONS, batch_size=2, file=file)
    assert resumed == whole
    assert policy.resets == 1
    assert sorted(e.session for e in read_episodes(path)) == sorted(SESSIONS)


def test_a_finished_evaluation_rolls_out_nothing(tmp_path):
    path = tmp_path / "seen.jsonl"
    first = roll_out(Lowest(), "seen", sessions=[3], file=EpisodeFile(path, STANDARD))
    policy = Lowest()
    file = EpisodeFile(path, STANDARD)
    assert roll_out(policy, "seen", sessions=[3], file=file) == first
    assert policy.decisions == 0


@pytest.mark.parametrize(
    "change", [{"fingerprint": "xyz"}, {"salt": 1}, {"data_version": 2}, {"track": "language"}]
)
def test_two_conditions_never_share_a_file(tmp_path, change):
    EpisodeFile(tmp_path / "seen.jsonl", STANDARD)
    with pytest.raises(ValueError, match=f"another {next(iter(change))}"):
        EpisodeFile(tmp_path / "seen.jsonl", replace(STANDARD, **change))


def test_a_damaged_line_is_named(tmp_path):
    path = tmp_path / "seen.jsonl"
    EpisodeFile(path, STANDARD)
    path.write_text('{"split": "seen"}\n')
    with pytest.raises(ValueError, match=r"Line 1 of .*seen\.jsonl is not an episode"):
        EpisodeFile(path, STANDARD)


def test_episodes_of_an_unknown_policy_are_not_adopted(tmp_path):
    path = tmp_path / "seen.jsonl"
    roll_out(Lowest(), "seen", sessions=[3], file=EpisodeFile(path, STANDARD))
    (tmp_path / "seen.header.json").unlink()
    with pytest.raises(ValueError, match=r"seen\.header\.json is not there; give another --out"):
        EpisodeFile(path, STANDARD)
    assert not (tmp_path / "seen.header.json").exists()


@pytest.mark.parametrize("content", [b"[]", b"{", b"", b"\xff", b"null"])
def test_a_damaged_header_is_named(tmp_path, content):
    EpisodeFile(tmp_path / "seen.jsonl", STANDARD)
    (tmp_path / "seen.header.json").write_bytes(content)
    with pytest.raises(ValueError, match=r"seen\.header\.json is damaged; give another --out"):
        EpisodeFile(tmp_path / "seen.jsonl", STANDARD)


def test_on_expert_states_the_packing_is_not_measured(tmp_path):
    path = tmp_path / "seen.jsonl"
    file = EpisodeFile(path, replace(STANDARD, expert_states=True))
    (episode,) = roll_out(Lowest(), "seen", sessions=[0], expert_states=True, file=file)
    line = json.loads(path.read_text())
    assert line["metrics"] == {"Category accuracy": category_accuracy(episode)}
    assert "failure_modes" not in line
    assert read_episodes(path) == [episode]


def test_an_evaluation_summarises_its_split(tmp_path, monkeypatch):
    seen = splits.SPLITS["seen"]
    monkeypatch.setitem(splits.SPLITS, "seen", replace(seen, users=seen.users[:12]))
    loaded_policy = cast(LoadedPolicy, Lowest())
    summary = Evaluator(loaded_policy, tmp_path, batch_size=32).evaluate(
        "seen", with_prompt_use=True, with_category_accuracy=True
    )
    assert summary.episodes == 12
    assert set(summary.metrics) >= {*METRICS, "Prompt use", "Category accuracy"}
    assert summary.metrics["Prompt use"].mean == 0  # it never looks at its prompt
    episodes, times = summary.failure_modes["ran out of decisions"]
    assert 0 < episodes <= times <= 12
    assert (tmp_path / "seen.json").exists()
    assert Evaluator(loaded_policy, tmp_path, batch_size=8).evaluate("seen").episodes == 12


def test_splits_count_the_same_in_their_mean(tmp_path, monkeypatch):
    for name, sessions in (("seen", 28), ("val", 14)):
        split = splits.SPLITS[name]
        monkeypatch.setitem(splits.SPLITS, name, replace(split, users=split.users[:sessions]))
    evaluator = Evaluator(cast(LoadedPolicy, Lowest()), tmp_path, batch_size=32)
    of_splits = [evaluator.evaluate(name).metrics["ED"] for name in ("seen", "val")]
    mean = evaluator.mean_of_splits(("seen", "val"))["ED"]
    assert mean.mean == pytest.approx((of_splits[0].mean + of_splits[1].mean) / 2)
    assert mean.low < mean.mean < mean.high
    # Two independent splits: the variance of their mean is a quarter of the sum of theirs.
    widths = [interval.high - interval.low for interval in of_splits]
    assert mean.high - mean.low == pytest.approx(np.hypot(*widths) / 2, rel=0.1)

"""Replays, and what is printed of them: the same bytes each time, the numbers of the episodes."""

import csv
import io
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from shutil import copytree
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console
from short_splits import SESSIONS, short_splits

from kitchen_prefs import instances
from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.evaluation.tiers import PREFERENCES
from kitchen_prefs.metrics import ALL_METRICS, Interval, mean_of_splits, summarise
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import TEST_SPLITS
from kitchen_prefs_leaderboard.replay import replay, write_line
from kitchen_prefs_leaderboard.score_formats import to_csv, to_json, to_tables
from kitchen_prefs_leaderboard.scoring import score_submissions
from kitchen_prefs_leaderboard.submission_format import Line
from kitchen_prefs_leaderboard.submission_writing import write_submission

pytestmark = pytest.mark.xdist_group("scoring")  # one fixture of the module serves all

BY_HAND = Path(__file__).parents[2] / "leaderboard" / "examples" / "by_hand.py"
MOST = 1_000_000  # bytes of a submission


def played_at_random(split, index, seed, jitter=0.0):
    """An episode of whatever may be chosen, given with an error of some metres and quaternions."""
    simulator = EpisodeSimulator(make_session(split, index))
    generator = np.random.default_rng(seed)
    while not (simulator.terminated or simulator.truncated):
        rows = simulator.observation.rows[instances.choosable(simulator.observation.rows)]
        pose = generator.choice(rows)[instances.POSE]
        simulator.act(pose + generator.normal(0, jitter, pose.shape))
    return simulator.episode()


@pytest.fixture(scope="module")
def rolled_out():
    """Episodes of random decisions."""
    return {
        split: [played_at_random(split, i, seed=i) for i in range(SESSIONS)]
        for split in TEST_SPLITS
    }


@pytest.fixture(scope="module")
def folder(rolled_out, make_entry, tmp_path_factory):
    """The submission of these episodes."""
    folder = tmp_path_factory.mktemp("random") / "submission"
    write_submission(make_entry("a").submission, rolled_out, folder)
    return folder


@pytest.fixture(scope="module")
def entry(folder):
    """That submission, scored."""
    with short_splits():
        return score_submissions([folder], 1)[0]


def printed(entry, by):
    """All that is printed of an entry."""
    console = Console(width=200, record=True, file=io.StringIO())
    console.print(*to_tables(entry, by))
    return [to_json([entry], by), to_csv([entry], by), console.export_text()]


def test_the_terminal_keeps_the_tens_of_an_interval():
    entry = SimpleNamespace(
        submission=SimpleNamespace(name="act"),
        tier=PREFERENCES,
        metrics={
            "seen": {"Refused": Interval(20.4, 20.1, 30.25), "Turn": Interval(0.2, -0.1, 1.0)}
        },
        failure_modes={"seen": {"wrong rack": 0}},
    )
    console = Console(width=200, record=True, file=io.StringIO())
    console.print(*to_tables(entry, None))
    text = console.export_text()
    assert "20.10 30.25" in text
    assert "-.10 1.00" in text


@pytest.mark.slow
@pytest.mark.usefixtures("few_sessions")
def test_a_submission_of_plain_python_is_scored(tmp_path):
    folder = tmp_path / "by_hand"
    subprocess.run([sys.executable, BY_HAND, folder], check=True)
    assert sum(file.stat().st_size for file in folder.iterdir()) < MOST
    score = ["leaderboard", "score", folder, "--format=json"]
    scored = subprocess.run(
        [sys.executable, "-m", "kitchen_prefs.cli", *score],
        check=True,
        capture_output=True,
        text=True,
    )
    (content,) = json.loads(scored.stdout)
    assert content["name"] == "By hand"
    assert list(content["splits"]) == [*TEST_SPLITS, "mean"]
    for metrics in content["splits"].values():
        assert list(metrics) == list(ALL_METRICS)
        assert all(one["low"] <= one["mean"] <= one["high"] for one in metrics.values())
        assert 0 < metrics["Score"]["mean"] < 0.5
        assert metrics["Success"]["mean"] == 0


@pytest.mark.usefixtures("few_sessions")
@pytest.mark.parametrize("by", [None, "preference", "count"])
def test_two_scorings_print_the_same_bytes(folder, entry, by):
    assert printed(score_submissions([folder], 2)[0], by) == printed(entry, by)


def test_a_replay_has_the_metrics_of_the_rollouts(rolled_out, entry):
    for split, episodes in rolled_out.items():
        assert entry.metrics[split] == {n: summarise(episodes, m) for n, m in ALL_METRICS.items()}
    assert entry.metrics["mean"] == {
        name: mean_of_splits(list(rolled_out.values()), metric)
        for name, metric in ALL_METRICS.items()
    }


def test_every_metric_of_every_split_is_printed_in_every_form(entry):
    as_json, as_csv, _ = printed(entry, None)
    splits = json.loads(as_json)[0]["splits"]
    rows = csv.DictReader(io.StringIO(as_csv))
    numbers = {
        (row["split"], row["metric"]): {end: float(row[end]) for end in ("mean", "low", "high")}
        for row in rows
    }
    assert numbers == {
        (split, name): splits[split][name] for split in splits for name in ALL_METRICS
    }
    assert numbers == {
        (split, name): {end: round(value, 4) for end, value in vars(interval).items()}
        for split, metrics in entry.metrics.items()
        for name, interval in metrics.items()
    }
    for metrics in entry.metrics.values():
        for interval in metrics.values():
            assert f"{interval.mean:.3f}" in printed(entry, None)[2]


@pytest.mark.parametrize("by", ["preference", "count"])
def test_the_groups_means_weighted_back_are_the_splits(entry, by):
    groups = entry.grouped(by)
    assert {split: len(of) for split, of in groups.items()} == {
        split: len({getattr(e, by) for e in episodes}) for split, episodes in entry.episodes.items()
    }
    for split, of_split in groups.items():
        labels = [str(getattr(episode, by)) for episode in entry.episodes[split]]
        for name, metric in ALL_METRICS.items():
            if name == "Turn":  # a mean over the episodes alone that have a turn
                continue
            mean = sum(of_split[label][name].mean for label in labels) / len(labels)
            assert mean == pytest.approx(entry.metrics[split][name].mean)
            first = [metric(e) for e in entry.episodes[split] if str(getattr(e, by)) == labels[0]]
            assert of_split[labels[0]][name].mean == pytest.approx(np.mean(first))


def test_an_untrusted_name_is_printed_verbatim(entry):
    name = "[/red] [bold]me[/] :skull:"
    theirs = replace(entry, submission=entry.submission.model_copy(update={"name": name}))
    for text in printed(theirs, "count"):
        assert name in text


def check_actions(episode, again):
    """An action is written rounded, or, where rounding chooses another row, as its row's pose."""
    simulator = EpisodeSimulator(make_session(episode.split, episode.session))
    for action, written in zip(episode.actions, again.actions, strict=True):
        instance = simulator.choose(action)[0]
        pose = simulator.observation.rows[simulator.observation.row_of(instance), instances.POSE]
        assert np.allclose(written, action, atol=5.1e-5, rtol=0) or np.array_equal(written, pose)
        simulator.decide(instance, written)


@settings(deadline=None, max_examples=30)
@given(
    st.sampled_from(TEST_SPLITS),
    st.integers(0, 5),
    st.integers(0, 1000),
    st.sampled_from([0, 0.001, 0.1, 10]),
)
def test_what_is_written_of_an_episode_is_that_episode(split, index, seed, jitter):
    episode = played_at_random(split, index, seed, jitter)
    line = Line.model_validate_json(write_line(episode).model_dump_json())
    again = replay(split, line, "here")
    assert replace(again, actions=episode.actions) == episode
    check_actions(episode, again)
    values = {name: metric(again) for name, metric in ALL_METRICS.items()}
    assert 0 <= values["Success"] <= values["PE"] <= 1
    assert 0 <= values["TE"] <= values["PE"]
    assert 0 <= values["Score"] <= 1
    assert values["ED"] <= values["ED_c"] <= 1
    assert values["ED_c without refused"] <= 1
    assert values["Turn"] is None or 0 <= values["Turn"] <= 1
    assert values["Refused"] == sum(again.refused)


def test_an_action_too_far_away_becomes_the_pose_that_it_chose():
    simulator = EpisodeSimulator(make_session("seen", 0))
    while not (simulator.terminated or simulator.truncated):
        simulator.act((5000.0, -5000.0, 0.0, 1.0, 0.0, 0.0, 0.0))
    line = write_line(simulator.episode())
    assert replay("seen", line, "here").decisions == simulator.episode().decisions
    assert max(abs(number) for action in line.actions for number in action) < 10


def test_an_action_whose_rounding_would_choose_another_becomes_its_pose(
    few_episodes,
):
    session = make_session("seen", 0)
    start, actions = EpisodeSimulator(session), few_episodes()["seen"][0].actions

    def between(share):
        """A pose from the expert's first action, at 0, to its second, at 1."""
        return tuple(a + share * (b - a) for a, b in zip(*actions[:2], strict=True))

    first, second = 0.0, 1.0  # close in on the place where the choice changes
    while second - first > 1e-9:
        middle = (first + second) / 2
        if start.choose(between(middle))[0] == start.choose(actions[0])[0]:
            first = middle
        else:
            second = middle
    kept = []
    for share in (first, second):
        simulator = EpisodeSimulator(session)
        while not (simulator.terminated or simulator.truncated):
            simulator.act(between(share))
        line = write_line(simulator.episode())
        assert replay("seen", line, "here").decisions == simulator.episode().decisions
        rounded = tuple(round(number, 4) for number in between(share))
        kept.append(line.actions[0] == rounded)
    assert sorted(kept) == [False, True]  # both are rounded to one pose, which chooses as one does


def test_two_entries_of_one_name_are_refused(folder, tmp_path, kitchen_prefs):
    twin = copytree(folder, tmp_path / "twin")
    said = kitchen_prefs("leaderboard", "score", folder, twin)
    assert said == (
        f"kitchen-prefs: {twin} and {folder} are both named 'a', or nearly; "
        "rename or leave out one."
    )


def test_two_entries_of_one_checkpoint_are_told(
    few_sessions, folder, tmp_path, kitchen_prefs, capsys
):
    twin = copytree(folder, tmp_path / "twin")
    described = json.loads((twin / "submission.json").read_text())
    (twin / "submission.json").write_text(json.dumps(described | {"name": "b"}))
    assert not kitchen_prefs("leaderboard", "score", folder, twin, "--format=csv", "--jobs=1")
    assert capsys.readouterr().err.endswith("'b' and 'a' are entries of one checkpoint.\n")

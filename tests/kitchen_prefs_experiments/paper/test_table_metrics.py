"""What a table counts: the metrics of its groups, from the lines that an evaluation wrote."""

import json
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, replace

import pytest

from kitchen_prefs.metrics import Episode
from kitchen_prefs.splits import HELD_OUT_USERS, SPLITS
from kitchen_prefs_experiments.paper import table_runner
from kitchen_prefs_experiments.paper.evaluated_policies import FineTuning, Rule, Training
from kitchen_prefs_experiments.paper.prepared_policies import Player, players_of
from kitchen_prefs_experiments.paper.rows import BASE
from kitchen_prefs_experiments.paper.table_metrics import measure_groups, pick_accuracy
from kitchen_prefs_experiments.paper.table_runner import run_table
from kitchen_prefs_experiments.paper.table_types import Table

# The expert picks a cup, places it, picks a glass and drops it in the sink.
EXPERT = ("cup", "in top", "glass", "in sink")
# A small TTP, so that a step takes milliseconds.
SMALL = ("--policy.dim_pose=16", "--policy.dim_extents=8", "--policy.dim_time=4", "--num_workers=0")


def episode(session, preference, *, placed=4, kinds=EXPERT):
    return Episode(
        split="val",
        session=session,
        salt=0,
        preference=preference,
        count=6 + session % 2,
        decisions=tuple(range(len(kinds))),
        kinds=kinds,
        expert_decisions=tuple(range(len(EXPERT))),
        expert_kinds=EXPERT,
        placed=(placed, placed),
        expert_placed=(4, 4),
        wrong_rack=0,
        sunk=0,
        expert_sunk=0,
        refused=(False,) * len(kinds),
        blocked_places=0,
        longest_loop=0,
        turns=(0, 0),
        closed_early=0,
        closed=True,
        finished=True,
        actions=((0.0,) * 7,) * len(kinds),
    )


def table(*metrics, prompt_use=(), by_count=False):
    rows = {"symbolic": Rule("symbolic")}
    return Table("", "", "", rows, ("val",), metrics, prompt_use=prompt_use, by_count=by_count)


def player(folder, preference=None, **files):
    """Someone whose evaluation wrote val.jsonl, and others with a longer name."""
    one = Player([], folder, {}, preference)
    one.episodes.mkdir(parents=True)
    for kind, episodes in files.items():
        name = "val" if kind == "val" else f"val-{kind.replace('_', '-')}"
        lines = "".join(json.dumps(asdict(line)) + "\n" for line in episodes)
        (one.episodes / f"{name}.jsonl").write_text(lines)
    return one


def mean(groups, metric, group="val"):
    return groups[group]["metrics"][metric]["mean"]


def test_a_player_counts_on_the_sessions_of_its_preference_alone(tmp_path):
    episodes = [episode(0, 0), episode(1, 0), episode(2, 1, placed=0), episode(3, 1, placed=0)]
    everyone = measure_groups(table("PE"), [player(tmp_path / "a", val=episodes)])
    of_first = measure_groups(table("PE"), [player(tmp_path / "b", 0, val=episodes)])
    assert (everyone["val"]["episodes"], mean(everyone, "PE")) == (4, 0.5)
    assert (of_first["val"]["episodes"], mean(of_first, "PE")) == (2, 1.0)


def test_several_players_share_a_row_each_with_its_preference(tmp_path):
    good = [episode(i, i // 2) for i in range(4)]
    bad = [replace(one, placed=(0, 0)) for one in good]
    players = [player(tmp_path / "a", 0, val=good), player(tmp_path / "b", 1, val=bad)]
    groups = measure_groups(table("PE", by_count=True), players)
    assert (groups["val"]["episodes"], mean(groups, "PE")) == (4, 0.5)
    assert {name: group["episodes"] for name, group in groups.items()} == {"6": 2, "7": 2, "val": 4}


def test_the_order_of_the_lines_changes_nothing(tmp_path):
    episodes = [episode(i, i % 2, placed=i % 5) for i in range(8)]
    forth = measure_groups(table("PE"), [player(tmp_path / "a", val=episodes)])
    back = measure_groups(table("PE"), [player(tmp_path / "b", val=episodes[::-1])])
    assert forth == back


def test_another_preferences_prompt_has_a_metric_of_its_own(tmp_path):
    right = [episode(i, 0) for i in range(2)]
    swapped = [episode(i, 0, placed=1) for i in range(2)]
    one = player(tmp_path, val=right, other_prompt=swapped)
    groups = measure_groups(table("PE", prompt_use=("val",)), [one])
    assert mean(groups, "PE, other prompt") == 0.25
    assert mean(groups, "Prompt use") == 0.75


def test_pick_accuracy_leaves_the_places_out(tmp_path):
    beside = [episode(i, 0, kinds=("cup", "in sink", "tray", "in sink")) for i in range(2)]
    one = player(tmp_path, val=beside, expert_states=beside)
    groups = measure_groups(table("Pick accuracy"), [one])
    assert pick_accuracy(beside[0]) == 0.5
    assert mean(groups, "Pick accuracy") == 0.5
    assert mean(groups, "Category accuracy") == 0.5
    assert pick_accuracy(episode(0, 0, kinds=("cup", "in sink", "glass", "in top"))) == 1


def test_a_fine_tuning_is_a_player_for_each_held_out_preference(tmp_path, monkeypatch):
    monkeypatch.setattr(
        "kitchen_prefs_experiments.paper.prepared_policies.train", lambda *_: tmp_path
    )
    monkeypatch.setattr(
        "kitchen_prefs_experiments.paper.prepared_policies.seconds_of", lambda *_: 3
    )
    players = players_of(FineTuning(BASE, 10), 32_000, tmp_path)
    assert [one.preference for one in players] == list(HELD_OUT_USERS)
    assert len({one.folder for one in players}) == len(HELD_OUT_USERS)
    assert all("--steps=10" in one.facts["options"] for one in players)
    sessions = SPLITS["unseen_preferences"]
    assert set(sessions.users) == {one.preference for one in players}


def test_tables_that_ask_for_one_player_play_it_one_after_the_other(tmp_path, monkeypatch):
    at_once, most = [], []

    def evaluate(*_):
        at_once.append(None)
        most.append(len(at_once))
        time.sleep(0.05)
        at_once.pop()

    monkeypatch.setattr(table_runner, "run_module", evaluate)
    one = Player([], tmp_path, {})
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: table_runner._play(one, table("PE"), "one"), range(4)))
    assert most == [1, 1, 1, 1]


@pytest.fixture
def home(tmp_path, monkeypatch):
    for name, value in (("HF_LEROBOT_HOME", tmp_path), ("HF_DATASETS_CACHE", tmp_path / "cache")):
        monkeypatch.setenv(name, str(value))
    return tmp_path


@pytest.mark.slow
def test_a_network_is_fine_tuned_on_one_demonstration(home, monkeypatch):
    monkeypatch.setattr(FineTuning, "trainings", property(_first_one(FineTuning.trainings.fget)))
    tiny = Training("tiny", "dishwasher-train-p2-d3-v1", 4, SMALL)
    table = Table(
        title="Tiny",
        paper="",
        axis="steps",
        rows={"0": tiny, "2": FineTuning(tiny, 2)},
        splits=("unseen_preferences",),
        metrics=("PE", "PE, other prompt"),
        prompt_use=("unseen_preferences",),
    )
    rows = run_table("tiny", table, 8, 2, home / "out")["rows"]
    assert rows["0"]["groups"]["unseen_preferences"]["episodes"] == 100
    assert rows["2"]["groups"]["unseen_preferences"]["episodes"] == 20
    assert rows["2"]["options"][2] == "--steps=2"
    assert all(
        "PE, other prompt" in row["groups"]["unseen_preferences"]["metrics"]
        for row in rows.values()
    )

    monkeypatch.setattr("kitchen_prefs_experiments.paper.training.run_module", pytest.fail)
    monkeypatch.setattr(table_runner, "_play", lambda *_: None)
    assert run_table("tiny", table, 8, 2, home / "out")["rows"] == rows


@pytest.mark.slow
def test_a_history_is_trained_and_measured_on_its_preference(home):
    tiny = Training(
        "tiny-history",
        "dishwasher-train-p1-d2-v1",
        4,
        (
            *SMALL,
            "--policy.context_history=2",
            "--policy.relabel=false",
            "--policy.situation_time=true",
        ),
        preference=0,
    )
    rows = {"2": tiny}
    table = Table("Tiny", "", "k", rows, ("val",), ("Pick accuracy",))
    (row,) = run_table("tiny", table, 8, 1, home / "out")["rows"].values()
    assert row["groups"]["val"]["episodes"] == 10
    assert 0 <= row["groups"]["val"]["metrics"]["Pick accuracy"]["mean"] <= 1


def _first_one(trainings):
    return lambda self: trainings(self)[:1]

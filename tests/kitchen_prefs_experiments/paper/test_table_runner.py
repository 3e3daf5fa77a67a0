"""A table is run: what is missing is said first, and what is there is not done again."""

import time
from concurrent.futures import ThreadPoolExecutor

import pytest
from short_splits import short_splits

from kitchen_prefs_experiments import lerobot_train
from kitchen_prefs_experiments.paper import table_runner
from kitchen_prefs_experiments.paper.evaluated_policies import Committed, FineTuning, Rule, Training
from kitchen_prefs_experiments.paper.prepared_policies import PreparedPolicy
from kitchen_prefs_experiments.paper.result_files import PolicyDescription
from kitchen_prefs_experiments.paper.table_runner import run_table
from kitchen_prefs_experiments.paper.table_types import Table

# A small TTP, so that a step takes milliseconds.
SMALL = ("--policy.dim_pose=16", "--policy.dim_extents=8", "--policy.dim_time=4", "--num_workers=0")


def test_a_checkpoint_that_is_not_there_is_said_before_anything_runs(tmp_path, monkeypatch):
    missing = Table("", "", "", {"x": Committed("no_such")}, ("seen",), ("PE",))
    monkeypatch.setattr(table_runner, "run_module", pytest.fail)
    with pytest.raises(ValueError, match="There is no checkpoint 'no_such'"):
        run_table("missing", missing, 32, 1, tmp_path)


def test_tables_that_share_a_policy_evaluate_it_one_after_the_other(tmp_path, monkeypatch):
    at_once, most = [], []

    def evaluate(*_):
        at_once.append(None)
        most.append(len(at_once))
        time.sleep(0.05)
        at_once.pop()

    monkeypatch.setattr(table_runner, "run_module", evaluate)
    one = PreparedPolicy([], tmp_path, PolicyDescription())
    table = Table("", "", "", {"symbolic": Rule("symbolic")}, ("val",), ("PE",))
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: table_runner._evaluate(one, table, "one"), range(4)))
    assert most == [1, 1, 1, 1]


@pytest.mark.lerobot
@pytest.mark.slow
def test_a_network_is_fine_tuned_on_one_demonstration(home, monkeypatch, two_preferences):
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
    rows = run_table("tiny", table, 8, 2, home / "out").rows
    assert rows["0"].groups["unseen_preferences"].episodes == 22
    assert rows["2"].groups["unseen_preferences"].episodes == 20
    assert rows["2"].options[2] == "--steps=2"
    assert all(
        "PE, other prompt" in row.groups["unseen_preferences"].metrics for row in rows.values()
    )

    monkeypatch.setattr(lerobot_train, "run_module", pytest.fail)
    monkeypatch.setattr(table_runner, "_evaluate", lambda *_: None)
    assert run_table("tiny", table, 8, 2, home / "out").rows == rows


@pytest.fixture
def two_preferences():
    """Cuts the split of held-out preferences down to twenty sessions of one and two of another."""
    with short_splits(22):
        yield


def _first_one(trainings):
    return lambda self: trainings(self)[:1]


@pytest.mark.lerobot
@pytest.mark.slow
@pytest.mark.usefixtures("few_sessions")
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
    (row,) = run_table("tiny", table, 8, 1, home / "out").rows.values()
    assert row.groups["val"].episodes == 6
    assert 0 <= row.groups["val"].metrics["Pick accuracy"].mean <= 1

"""The commands `reproduce` and `results`, with a table of a tiny training and a rule."""

import json

import pytest
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line
from kitchen_prefs_experiments.paper import paper_tables
from kitchen_prefs_experiments.paper.evaluated_policies import Rule, Training
from kitchen_prefs_experiments.paper.table_types import Table

# A small TTP, so that a step takes milliseconds.
SMALL = ("--policy.dim_pose=16", "--policy.dim_extents=8", "--policy.dim_time=4", "--num_workers=0")


def run(*arguments):
    return CliRunner().invoke(command_line(), list(map(str, arguments)))


@pytest.mark.lerobot
@pytest.mark.slow
@pytest.mark.usefixtures("few_sessions")
def test_a_tiny_table_is_run_once_and_reported(tmp_path, monkeypatch):
    tiny = Training("tiny", "dishwasher-train-p2-d3-v1", 4, SMALL)
    table = Table(
        title="Tiny",
        paper="Nothing.",
        axis="dishes per rack",
        rows={"TTP": tiny, "symbolic": Rule("symbolic")},
        splits=("val",),
        metrics=("PE", "Category accuracy"),
        by_count=True,
    )
    monkeypatch.setitem(paper_tables.TABLES, "tiny", table)
    for name, value in (("HF_LEROBOT_HOME", tmp_path), ("HF_DATASETS_CACHE", tmp_path / "cache")):
        monkeypatch.setenv(name, str(value))
    options = ("--budget=8", f"--out={tmp_path / 'out'}", f"--results={tmp_path / 'results'}")
    done = run("reproduce", "tiny", *options)
    assert done.exit_code == 0, done.exception
    log = (tmp_path / "out" / "8" / "tiny" / "train.log").read_text()
    written = (tmp_path / "results" / "tiny.json").read_text()
    facts = json.loads(written)
    assert facts["rows"]["TTP"]["options"][1:3] == ["--batch_size=4", "--steps=2"]
    groups = facts["rows"]["symbolic"]["groups"]
    assert {name: group["episodes"] for name, group in groups.items()} == {
        "6": 3,
        "7": 3,
        "val": 6,
    }

    assert run("reproduce", "tiny", *options).exit_code == 0
    assert (tmp_path / "out" / "8" / "tiny" / "train.log").read_text() == log
    assert (tmp_path / "results" / "tiny.json").read_text() == written

    assert run("results", f"--results={tmp_path / 'results'}").exit_code == 0
    text = (tmp_path / "results" / "tiny.md").read_text()
    assert "symbolic 1.00 [1.00, 1.00]." in text
    assert "### Category accuracy\n\n|  | val (6) |" in text

"""The ladder of the second tier: readers that know more reach more."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line
from kitchen_prefs.metrics.people_episode import turn, where
from kitchen_prefs.metrics.people_intervals import summarise_people
from kitchen_prefs.metrics.references import people_reference_scores
from kitchen_prefs.people.splits import PEOPLE_SPLITS
from kitchen_prefs_experiments.people.ladder import climb, load_all

ROOT = Path(__file__).parents[3]
SPLIT = "people_three"


@pytest.fixture(scope="module")
def episodes():
    return [load_all((SPLIT, index, 0)) for index in range(10)]


def test_who_knows_the_grammar_is_near_the_expert_and_a_rule_of_categories_is_not(episodes):
    h = {name: summarise_people([one[name] for one in episodes])["H"].mean for name in episodes[0]}
    assert h["expert"] == 1
    assert h["bayes"] > 0.95
    assert h["category"] < 0.6
    assert h["promptless"] < h["tree"] < h["bayes"]


def test_the_headline_is_the_mean_of_where_and_turn(episodes):
    own = [one["tree"] for one in episodes]
    metrics = summarise_people(own)
    turns = [value for one in own if (value := turn(one)) is not None]
    assert metrics["Where"].mean == pytest.approx(sum(map(where, own)) / len(own))
    assert metrics["Turn"].mean == pytest.approx(sum(turns) / len(turns))
    assert metrics["H"].mean == pytest.approx((metrics["Where"].mean + metrics["Turn"].mean) / 2)
    for interval in metrics.values():
        assert interval.low <= interval.mean <= interval.high
    with pytest.raises(ValueError, match="no episodes"):
        summarise_people([])


@pytest.mark.slow
def test_the_command_writes_the_ladder(tmp_path, monkeypatch):
    monkeypatch.setattr(climb, "__defaults__", (None, 0, ("people_partial",)))
    arguments = ["people", "ladder", "--sessions=2", f"--out={tmp_path}"]
    done = CliRunner().invoke(command_line(), arguments)
    assert done.exit_code == 0, done.output
    facts = json.loads((tmp_path / "ladder.json").read_text())
    assert set(facts["people_partial"]["bayes"]) >= {"H", "Where", "Turn", "Care"}
    assert "| `bayes` | 1.00 |" in (tmp_path / "ladder.md").read_text()


def test_floors_and_ceilings_are_those_of_the_published_ladder():
    published = json.loads((ROOT / "docs/results/people/ladder.json").read_text())
    assert set(published) == set(people_reference_scores())
    for split, references in people_reference_scores().items():
        h = {name: metrics["H"]["mean"] for name, metrics in published[split].items()}
        assert references["floor"] == pytest.approx(h["promptless"], abs=1e-4)
        assert references["ceiling"] == pytest.approx(h["bayes"], abs=1e-4)
        if PEOPLE_SPLITS[split].certified:
            assert h["category"] < 0.6
            assert h["bayes"] > 0.95

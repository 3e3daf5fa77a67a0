"""`kitchen-prefs robot run` and `robot table`, with a committed policy."""

import json

import pytest
from typer.testing import CliRunner

pytest.importorskip("gym_hil", reason="needs the extra robot")

from kitchen_prefs.cli import command_line
from kitchen_prefs_experiments.checkpoints import find_checkpoint
from kitchen_prefs_robot.execution.outcome_files import OutcomeFile
from kitchen_prefs_robot.execution.outcomes import EpisodeOutcome
from kitchen_prefs_robot.execution.trials import Trial

GIVEN = "--variation=perfect perception and grasps"


def run(*arguments):
    policy = f"--policy.path={find_checkpoint('ttp_drawers')}"
    return CliRunner().invoke(command_line(), ["robot", arguments[0], policy, *arguments[1:]])


@pytest.mark.slow
def test_a_run_leaves_a_log_of_every_decision(tmp_path):
    out = tmp_path / "out"
    done = run("run", "--scene=3", "--preference=2", GIVEN, f"--out={out}")
    assert done.exit_code == 0, done.exception
    assert "4 of 4 dishes right after 12 decisions, 0 failed picks" in done.stdout
    lines = [json.loads(line) for line in (out / "decisions.jsonl").read_text().splitlines()]
    assert [line["decision"] for line in lines] == list(range(1, 13))
    assert lines[0]["chosen"] == "open the upper drawer"
    assert lines[1]["chosen"].startswith("pick the ")
    assert all(line["result"] == "done" and not line["refusal"] for line in lines)
    assert json.loads((out / "outcome.json").read_text())["right"] == 1.0


@pytest.mark.slow
def test_a_table_resumes_and_refuses_another_policys_outcomes(tmp_path):
    options = ("--scenes=1", "--first=3", "--preferences=2", GIVEN, f"--out={tmp_path}")
    shown = run("table", *options)
    assert shown.exit_code == 0, shown.exception
    assert "2 of 2" in shown.stdout
    (file,) = tmp_path.glob("*.jsonl")
    lines = file.read_text().splitlines()
    assert len(lines) == 2
    file.write_text(lines[0] + "\n" + lines[1][:40])  # killed while it wrote
    assert run("table", *options).exit_code == 0
    again = json.loads(file.read_text().splitlines()[-1])
    assert again == json.loads(lines[1])
    file.write_text(lines[0].replace('"policy": "', '"policy": "x') + "\n")
    said = str(run("table", *options).exception)
    assert said == f"{file} has outcomes of another policy; give another --out."


def test_outcomes_that_were_made_otherwise_are_refused(tmp_path):
    file = OutcomeFile(tmp_path, "all real", "0123")
    outcome = EpisodeOutcome(4, 1.0, 1.0, True, 12, 0, 0, 0, 1, 0, "", {}, 90.0)
    file.add(Trial(1000, 2), outcome)
    assert file.read() == {Trial(1000, 2): outcome}
    line = file.path.read_text()
    for changed, sentence in (
        (line.replace('"lamp": 0.1', '"lamp": 0.3'), "outcomes of other conditions"),
        (line.replace('"counting": 2', '"counting": 1'), "were counted in another way"),
        (line.replace('"trial"', '"run"'), "lines that are no outcomes"),
        ("[1, 2]\n", "lines that are no outcomes"),
    ):
        file.path.write_text(changed)
        with pytest.raises(ValueError, match=f"^{file.path} has .*{sentence}; give another --out"):
            file.read()


def never(*_):
    raise AssertionError("nothing is recorded for a command that is refused")


def test_a_folder_that_holds_something_is_left_alone(tmp_path, monkeypatch):
    monkeypatch.setattr("kitchen_prefs_robot.execution.prompts.record", never)
    (tmp_path / "mine").write_text("mine")
    said = str(run("run", "--scene=3", f"--out={tmp_path}").exception)
    assert said == f"{tmp_path} holds something already; give another --out."
    assert (tmp_path / "mine").read_text() == "mine"


def test_a_policy_that_there_is_not_is_noticed_before_a_demonstration_is_recorded(
    tmp_path, monkeypatch
):
    monkeypatch.setattr("kitchen_prefs_robot.execution.prompts.record", never)
    arguments = ["robot", "run", "--policy.path=nowhere", "--scene=3", f"--out={tmp_path / 'out'}"]
    said = str(CliRunner().invoke(command_line(), arguments).exception)
    assert "nowhere" in said
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("run", "--scene=3", "--variation=nothing"), "There is no variation 'nothing'."),
        (
            ("run", "--scene=3", "--demonstration=nowhere"),
            "There is no data set of demonstrations in nowhere; give its folder.",
        ),
        (("table", "--variation=all reel"), "Did you mean 'all real'?"),
    ],
)
def test_a_mistake_is_one_sentence(arguments, sentence, tmp_path):
    said = str(run(*arguments, f"--out={tmp_path / 'out'}").exception)
    assert sentence in said
    assert "\n" not in said
    assert not (tmp_path / "out" / "decisions.jsonl").exists()

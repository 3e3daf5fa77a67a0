"""Loading policies, and the commands `evaluate` and `select`, with a tiny ACT and the rules."""

import json

import pytest
from act_checkpoints import call, save_act

from kitchen_prefs.evaluation.episode_files import read_episodes
from kitchen_prefs.metrics import METRICS


@pytest.mark.usefixtures("few_sessions")
def test_evaluate_keeps_one_line_an_episode(tmp_path):
    path, out = save_act(tmp_path / "act"), tmp_path / "out"
    result = call("evaluate", f"--policy.path={path}", "--split=noisy,seen,noisy", f"--out={out}")
    assert "Score" in result.output
    assert result.output.count("noisy, 5 episodes") == 1
    assert result.output.count("mean of the splits") == 2  # the table and that of further metrics
    assert result.output.split("mean of the splits")[-1].count("95 % from") == 1
    assert len(read_episodes(out / "noisy.jsonl")) == 5
    assert json.loads((out / "seen.json").read_text())["episodes"] == 5


@pytest.mark.usefixtures("few_sessions")
def test_evaluate_refuses_two_policies_in_one_folder(tmp_path):
    out = tmp_path / "out"
    first, other = save_act(tmp_path / "first"), save_act(tmp_path / "other", seed=1)
    call("evaluate", f"--policy.path={first}", "--split=noisy", f"--out={out}")
    with pytest.raises(ValueError, match="another fingerprint"):
        call("evaluate", f"--policy.path={other}", "--split=noisy", f"--out={out}")


@pytest.mark.usefixtures("few_sessions")
def test_the_expert_rule_is_perfect(tmp_path):
    arguments = ("--policy.type=rules", "--policy.rule=expert", "--track=privileged")
    call("evaluate", *arguments, "--split=seen", f"--out={tmp_path}")
    metrics = json.loads((tmp_path / "seen.json").read_text())["metrics"]
    assert {metrics[name]["low"] for name in (*METRICS, "Turn", "ED_c without refused")} == {1}
    assert metrics["Refused"]["high"] == 0
    assert metrics["Rescaled"]["mean"] > 1  # the expert knows what no prompt shows


@pytest.mark.parametrize("place", ["/proc/kitchen_prefs", "file", "file/below"])
def test_a_folder_that_cannot_be_written_is_refused_before_the_policy_is_loaded(tmp_path, place):
    (tmp_path / "file").touch()
    out = tmp_path / place
    with pytest.raises(OSError, match=f"^{out} cannot be written; give another --out.$"):
        call("evaluate", "--policy.path=nowhere", "--split=seen", f"--out={out}")


def test_unknown_options_are_refused(tmp_path):
    for wrong in ("--splitt=seen", "--policy.rule"):
        with pytest.raises(ValueError, match=f"no option '{wrong}'"):
            call("evaluate", "--split=seen", f"--out={tmp_path}", wrong)

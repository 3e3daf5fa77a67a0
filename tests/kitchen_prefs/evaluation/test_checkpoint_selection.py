"""`kitchen-prefs select`: the best checkpoint of a run."""

import json

import pytest
from act_checkpoints import call, save_act


@pytest.mark.usefixtures("few_sessions")
def test_select_names_the_best_checkpoint(tmp_path):
    for seed, step in enumerate(("000100", "000200")):
        save_act(tmp_path / "checkpoints" / step / "pretrained_model", seed)
    (tmp_path / "checkpoints" / "last").symlink_to("000200")
    result = call("select", str(tmp_path))
    selection = json.loads((tmp_path / "selection.json").read_text())
    scores = {step: m["Score"]["mean"] for step, m in selection["checkpoints"].items()}
    assert set(scores) == {"000100", "000200"}
    best = max(scores, key=lambda step: scores[step])
    assert selection["best"] == f"checkpoints/{best}/pretrained_model"
    assert best in result.output
    assert result.output.count("95 % from") == 2


def test_a_run_without_checkpoints_cannot_be_selected_from(tmp_path):
    with pytest.raises(ValueError, match="holds no checkpoints"):
        call("select", str(tmp_path))

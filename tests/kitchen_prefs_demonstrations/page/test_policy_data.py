"""Which checkpoints a page runs, and what is said of the others."""

import base64
import json
from pathlib import Path
from shutil import copytree

import pytest
import torch
from safetensors.torch import load, load_file

from kitchen_prefs_demonstrations.page.policy_data import policy_data

CHECKPOINTS = Path(__file__).parents[3] / "policies/checkpoints"

pytestmark = pytest.mark.lerobot


@pytest.mark.parametrize("name", ["ttp_plus", "ttp_quick"])
def test_the_weights_are_the_checkpoints_own_in_half_precision(name):
    weights = load(base64.b64decode(policy_data(CHECKPOINTS / name)["weights"]))
    own = load_file(CHECKPOINTS / name / "model.safetensors")
    assert weights.keys() == own.keys()
    for weight, values in weights.items():
        assert torch.equal(values, own[weight].to(values.dtype)), weight
        assert values.dtype == (torch.float16 if weight.startswith("network.") else torch.float32)


def test_other_settings_are_refused():
    with pytest.raises(ValueError, match="has prompt_tokens 'final', and a page runs"):
        policy_data(CHECKPOINTS / "ttp_final")


def test_other_policies_are_refused():
    with pytest.raises(ValueError, match="of the type 'gnn', and a page runs 'ttp' alone"):
        policy_data(CHECKPOINTS / "gnn_tuned")


def test_a_checkpoint_whose_weights_do_not_fit_is_refused(tmp_path):
    folder = copytree(CHECKPOINTS / "ttp_quick", tmp_path / "other")
    config = json.loads((folder / "config.json").read_text())
    (folder / "config.json").write_text(json.dumps(config | {"dim_feedforward": 64}))
    with pytest.raises(ValueError, match="do not fit the config"):
        policy_data(folder)


def test_a_folder_without_a_policy_is_refused(tmp_path):
    with pytest.raises(ValueError, match="There is no policy in"):
        policy_data(tmp_path)

"""LoRA adapters of the committed checkpoints: trained by LeRobot, loaded by the benchmark."""

from dataclasses import replace
from pathlib import Path
from shutil import copytree

import numpy as np
import pytest
import torch
from act_checkpoints import rewrite
from lerobot.configs import PreTrainedConfig
from lerobot.policies import get_policy_class, make_pre_post_processors
from lerobot.utils.import_utils import is_package_available
from safetensors.torch import load_file, save_file

from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.evaluation import adapter_reading, checkpoint_reading
from kitchen_prefs.evaluation.isolation.isolated_policy import IsolatedPolicy
from kitchen_prefs.evaluation.isolation.policy_settings import policy_settings
from kitchen_prefs.evaluation.policy_loading import load_policy

CHECKPOINTS = Path(__file__).parents[2] / "policies/checkpoints"
needs_peft = pytest.mark.skipif(not is_package_available("peft"), reason="needs the extra peft")


def save_adapter(name, folder):
    """Wrap a checkpoint as lerobot-train --peft.method_type=LORA does, change it, and save it."""
    below = CHECKPOINTS / name
    config = PreTrainedConfig.from_pretrained(below)
    config.pretrained_path = below
    policy = get_policy_class(config.type).from_pretrained(below, config=config)
    adapted = policy.wrap_with_peft(peft_cli_overrides={"method_type": "LORA", "r": 4})
    torch.manual_seed(0)
    with torch.no_grad():
        for weight in adapted.parameters():
            if weight.requires_grad:
                weight.add_(0.3 * torch.randn_like(weight))
    adapted.save_pretrained(folder)
    config.save_pretrained(folder)
    for processor in make_pre_post_processors(config, str(below)):
        processor.save_pretrained(folder)
    return adapted.eval()


def first_actions(loaded):
    """The first actions of twenty sessions."""
    env = DishwasherLoading("val", loaded.track)
    observations = [env.reset(options={"session": session})[0] for session in range(20)]
    loaded.reset()
    torch.manual_seed(0)  # gnn_paper draws rows
    return loaded.act(observations, [""] * 20)


@needs_peft
@pytest.mark.parametrize("name", ["ttp_quick", "ttp_paper", "gnn_tuned", "gnn_paper"])
def test_an_adapter_on_default_targets_acts_as_it_was_trained(name, tmp_path):
    adapted = save_adapter(name, tmp_path)
    loaded, below = load_policy(str(tmp_path)), load_policy(str(CHECKPOINTS / name))
    found = first_actions(loaded)
    np.testing.assert_allclose(found, first_actions(replace(loaded, policy=adapted)), atol=1e-5)
    assert not np.allclose(found, first_actions(below))
    assert loaded.fingerprint != below.fingerprint


@needs_peft
def test_a_damaged_adapter_is_one_sentence(tmp_path):
    save_adapter("gnn_paper", tmp_path)
    weights = tmp_path / "adapter_model.safetensors"
    whole = weights.read_bytes()
    weights.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match=r"The adapter in .* is damaged or does not fit"):
        load_policy(str(tmp_path))
    weights.unlink()
    with pytest.raises(ValueError, match=r"lacks adapter_model\.safetensors"):
        load_policy(str(tmp_path))
    (tmp_path / "adapter_config.json").write_text('{"base_model_name_or_path": "nowhere/at-all"}')
    weights.write_bytes(whole)
    with pytest.raises(
        ValueError,
        match=r"The adapter in .* was trained on nowhere/at-all, which is not here; write",
    ):
        load_policy(str(tmp_path))


@needs_peft
def test_without_peft_an_adapter_says_what_to_install(tmp_path, monkeypatch):
    save_adapter("gnn_paper", tmp_path)
    monkeypatch.setattr(adapter_reading, "is_package_available", lambda _: False)
    with pytest.raises(ValueError, match=r"needs PEFT; install it: pip install 'lerobot\[peft\]'"):
        load_policy(str(tmp_path))


@needs_peft
def test_an_adapter_of_a_policy_on_the_hub_loads_in_a_process_of_its_own(tmp_path, monkeypatch):
    adapter = tmp_path / "adapter"
    save_adapter("gnn_tuned", adapter)
    known = load_policy(str(adapter)).fingerprint
    rename_below(adapter, "somebody/gnn_tuned")
    cache = linked(CHECKPOINTS / "gnn_tuned", tmp_path / "cache")
    monkeypatch.setattr(checkpoint_reading, "snapshot_download", lambda *_, **__: str(cache))
    settings = policy_settings(str(adapter), None, (), "privileged")
    with IsolatedPolicy(settings, tmp_path / "log") as policy:
        assert policy.fingerprint == known


def linked(folder, cache):
    """A folder of links to copies of files, as the hub's cache has it."""
    copytree(folder, cache / "blobs")
    snapshot = cache / "snapshots/main"
    snapshot.mkdir(parents=True)
    for file in (cache / "blobs").iterdir():
        (snapshot / file.name).symlink_to(file)
    return snapshot


def rename_below(adapter, name):
    rewrite(
        adapter / "adapter_config.json", lambda found: found.update(base_model_name_or_path=name)
    )


@needs_peft
def test_an_adapter_is_known_by_its_own_weights_and_the_policy_below_it(tmp_path, monkeypatch):
    adapter, below = tmp_path / "adapter", tmp_path / "below"
    save_adapter("gnn_paper", adapter)
    known = load_policy(str(adapter)).fingerprint
    read = checkpoint_reading.read_adapted_policy

    def merged_otherwise(*arguments):
        policy = read(*arguments)
        with torch.no_grad():
            next(policy.parameters()).add_(1e-6)  # as another processor rounds
        return policy

    with monkeypatch.context() as here:
        here.setattr(checkpoint_reading, "read_adapted_policy", merged_otherwise)
        assert load_policy(str(adapter)).fingerprint == known
    copytree(CHECKPOINTS / "gnn_paper", below)
    rename_below(adapter, str(below))
    assert load_policy(str(adapter)).fingerprint == known
    change(below / "model.safetensors")
    assert load_policy(str(adapter)).fingerprint != known
    rename_below(adapter, str(CHECKPOINTS / "gnn_paper"))
    change(adapter / "adapter_model.safetensors")
    assert load_policy(str(adapter)).fingerprint != known


def change(file):
    """Change one weight."""
    weights = load_file(file)
    next(iter(weights.values())).view(-1)[0] += 1
    save_file(weights, file)

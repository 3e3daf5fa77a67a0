"""Damaged checkpoints are named in one sentence."""

import json

import pytest
from act_checkpoints import rewrite, save_act
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from safetensors.torch import load_file, save_file

from kitchen_prefs.evaluation.policy_loading import load_policy


def test_a_processor_step_that_names_a_program_is_not_run(tmp_path):
    folder, trace = save_act(tmp_path / "policy"), tmp_path / "trace"
    step = {"class": "subprocess.Popen", "config": {"args": ["touch", str(trace)]}}
    rewrite(folder / "policy_preprocessor.json", lambda found: found["steps"].append(step))
    with pytest.raises(ValueError, match=r"policy_preprocessor\.json has a step that is not reg"):
        load_policy(str(folder))
    assert not trace.exists()


@pytest.mark.parametrize(
    "file", ["model.safetensors", "policy_preprocessor.json", "policy_postprocessor.json"]
)
def test_a_checkpoint_that_lacks_a_file_is_refused(tmp_path, file):
    (save_act(tmp_path) / file).unlink()
    with pytest.raises(ValueError, match=f"^The checkpoint {tmp_path} lacks {file}; give another"):
        load_policy(str(tmp_path))


@pytest.mark.parametrize(
    "file",
    ["config.json", "model.safetensors", "policy_preprocessor.json", "policy_postprocessor.json"],
)
@pytest.mark.parametrize("content", [b"", b"[]", b'{"steps": 3}', b"\xff\xfe"])
def test_a_damaged_file_of_a_checkpoint_is_named(tmp_path, file, content):
    (save_act(tmp_path) / file).write_bytes(content)
    with pytest.raises(ValueError, match=f"{tmp_path}.*; give another checkpoint") as caught:
        load_policy(str(tmp_path))
    assert "\n" not in str(caught.value)
    if content != b'{"steps": 3}':  # which is JSON, but neither a config nor a processor
        assert file in str(caught.value)


def test_truncated_files_of_a_checkpoint_are_refused(tmp_path):
    checkpoint = save_act(tmp_path)
    for file in sorted(checkpoint.iterdir()):
        if file.name == "train_config.json":
            continue
        whole = file.read_bytes()
        file.write_bytes(whole[: len(whole) // 2])
        with pytest.raises(ValueError, match="; give another checkpoint"):
            load_policy(str(checkpoint))
        file.write_bytes(whole)


@pytest.mark.parametrize(
    ("program", "error"),
    [
        (ACTPolicy, AttributeError),
        (ACTPolicy, KeyError),
        (ACTPolicy, TypeError),
        (ACTConfig, AttributeError),  # draccus hides a TypeError itself
        (ACTConfig, KeyError),
    ],
)
def test_a_mistake_in_a_policy_is_not_taken_for_a_damaged_checkpoint(
    tmp_path, monkeypatch, error, program
):
    checkpoint, cause = save_act(tmp_path), error("ours")

    def broken(*_, **__):
        raise cause

    monkeypatch.setattr(program, "__post_init__" if program is ACTConfig else "__init__", broken)
    with pytest.raises(error) as caught:
        load_policy(str(checkpoint))
    assert caught.value is cause
    assert "broken" in {entry.name for entry in caught.traceback}


@pytest.mark.parametrize("steps", [None, 3, [None], ["normalizer_processor"]])
def test_steps_that_are_none_are_refused(tmp_path, steps):
    file = save_act(tmp_path) / "policy_preprocessor.json"
    rewrite(file, lambda processor: processor.update(steps=steps))
    with pytest.raises(ValueError, match=r"policy_preprocessor\.json is damaged"):
        load_policy(str(tmp_path))


def test_a_checkpoint_of_an_unknown_type_is_answered_with_the_nearest(tmp_path):
    checkpoint = save_act(tmp_path)
    config = json.loads((checkpoint / "config.json").read_text())
    (checkpoint / "config.json").write_text(json.dumps(config | {"type": "tttp"}))
    with pytest.raises(ValueError, match=r"config\.json .*type 'tttp'\. Did you mean 'ttp'"):
        load_policy(str(checkpoint))


def test_a_checkpoint_with_a_setting_that_does_not_exist_is_refused(tmp_path):
    checkpoint = save_act(tmp_path)
    config = json.loads((checkpoint / "config.json").read_text())
    (checkpoint / "config.json").write_text(json.dumps(config | {"no_such_setting": 1}))
    with pytest.raises(ValueError, match=r"config\.json is damaged"):
        load_policy(str(checkpoint))


def test_a_weight_that_is_missing_is_not_drawn_at_random(tmp_path):
    checkpoint = save_act(tmp_path)
    weights = load_file(checkpoint / "model.safetensors")
    weights.pop(sorted(weights)[0])
    save_file(weights, checkpoint / "model.safetensors")
    with pytest.raises(ValueError, match="do not fit the config"):
        load_policy(str(checkpoint))


def test_weights_that_do_not_fit_their_config_are_refused(tmp_path):
    checkpoint = save_act(tmp_path / "checkpoint")
    config = json.loads((checkpoint / "config.json").read_text())
    (checkpoint / "config.json").write_text(json.dumps(config | {"dim_model": 32}))
    with pytest.raises(ValueError, match="do not fit the config"):
        load_policy(str(checkpoint))


def test_an_override_that_does_not_fit_the_weights_is_named(tmp_path):
    checkpoint = save_act(tmp_path / "checkpoint")
    with pytest.raises(ValueError, match="do not fit with --dim_model=32; leave out"):
        load_policy(str(checkpoint), options=["--dim_model=32"])

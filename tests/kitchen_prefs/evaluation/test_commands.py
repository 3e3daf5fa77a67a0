"""Loading policies, and the commands `evaluate` and `select`, with a tiny ACT and the rules."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.policies import make_pre_post_processors
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from lerobot.utils.constants import ACTION, OBS_ENV_STATE, OBS_STATE
from safetensors.torch import load_file, save_file
from typer.testing import CliRunner

from kitchen_prefs import splits
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE_SIZE, STATE_SIZE
from kitchen_prefs.evaluation import commands
from kitchen_prefs.evaluation.episode_files import read_episodes
from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.metrics import METRICS


@pytest.fixture
def few_sessions(monkeypatch):
    """Cut the splits that these tests roll out down to their first five sessions."""
    for name in ("val", "seen", "noisy"):
        split = splits.SPLITS[name]
        monkeypatch.setitem(splits.SPLITS, name, replace(split, users=split.users[:5]))


def save_act(folder: Path, seed: int = 0, state_size: int = STATE_SIZE) -> Path:
    """Save an untrained ACT as `lerobot-train` saves a checkpoint."""
    config = ACTConfig(
        input_features={
            OBS_STATE: PolicyFeature(FeatureType.STATE, (state_size,)),
            OBS_ENV_STATE: PolicyFeature(FeatureType.ENV, (ENVIRONMENT_STATE_SIZE,)),
        },
        output_features={ACTION: PolicyFeature(FeatureType.ACTION, (7,))},
        device="cpu",
        chunk_size=4,
        n_action_steps=4,
        dim_model=16,
        n_heads=2,
        dim_feedforward=16,
        n_encoder_layers=1,
        n_decoder_layers=1,
        use_vae=False,
        pretrained_backbone_weights=None,
    )
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        policy = ACTPolicy(config)
    policy.save_pretrained(folder)
    for processor in make_pre_post_processors(config):
        processor.save_pretrained(folder)
    return folder


def call(*arguments: str):
    result = CliRunner().invoke(commands.app, arguments)
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def test_a_checkpoint_is_known_by_its_weights(tmp_path):
    one = load_policy(str(save_act(tmp_path / "one")))
    again = load_policy(str(save_act(tmp_path / "again")))
    other = load_policy(str(save_act(tmp_path / "other", seed=1)))
    assert one.fingerprint == again.fingerprint != other.fingerprint


def test_a_setting_that_changes_what_it_does_changes_the_fingerprint(tmp_path):
    path = str(save_act(tmp_path))
    assert load_policy(path, options=["--n_action_steps=1"]).fingerprint != (
        load_policy(path).fingerprint
    )
    assert load_policy(path, options=["--push_to_hub=false"]).fingerprint == (
        load_policy(path).fingerprint
    )


def rewrite(file, change):
    """Change a JSON file in place."""
    content = json.loads(file.read_text())
    change(content)
    file.write_text(json.dumps(content))


def test_a_processor_that_changes_what_it_does_changes_the_fingerprint(tmp_path):
    before = load_policy(str(save_act(tmp_path))).fingerprint
    rewrite(
        tmp_path / "policy_postprocessor.json",
        lambda processor: processor["steps"][0]["config"].update(eps=5.0),
    )
    assert load_policy(str(tmp_path)).fingerprint != before


def test_a_processor_step_that_names_a_program_is_not_run(tmp_path):
    folder, trace = save_act(tmp_path / "policy"), tmp_path / "trace"
    step = {"class": "subprocess.Popen", "config": {"args": ["touch", str(trace)]}}
    rewrite(folder / "policy_preprocessor.json", lambda found: found["steps"].append(step))
    with pytest.raises(ValueError, match=r"policy_preprocessor\.json has a step that is not reg"):
        load_policy(str(folder))
    assert not trace.exists()


def test_a_checkpoint_that_does_not_fit_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"'observation\.state' of shape \(9,\)"):
        load_policy(str(save_act(tmp_path, state_size=9)))


def test_unknown_policies_and_settings_are_refused_with_the_nearest(tmp_path):
    with pytest.raises(ValueError, match="Did you mean 'rules'"):
        load_policy(policy_type="rule")
    with pytest.raises(ValueError, match="Did you mean 'rule'"):
        load_policy(policy_type="rules", options=["--rul=expert"])
    with pytest.raises(ValueError, match="Did you mean 'expert'"):
        load_policy(policy_type="rules", options=["--rule=exprt"])
    with pytest.raises(ValueError, match="no setting 'dim_modl'"):
        load_policy(str(save_act(tmp_path)), options=["--dim_modl=3"])


def test_a_folder_without_a_policy_is_refused(tmp_path):
    with pytest.raises(ValueError, match="There is no policy in"):
        load_policy(str(tmp_path))
    with pytest.raises(ValueError, match="There is no policy in"):
        load_policy(str(tmp_path / "nowhere"))
    with pytest.raises(ValueError, match="Give either"):
        load_policy()


@pytest.mark.parametrize("policy_type", ["act", "ttp"])
def test_a_policy_that_has_to_be_trained_is_not_scored_untrained(policy_type):
    with pytest.raises(ValueError, match=f"'{policy_type}' has to be trained first: give --policy"):
        load_policy(policy_type=policy_type)


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


def test_weights_that_do_not_fit_their_config_are_refused(tmp_path):
    checkpoint = save_act(tmp_path / "checkpoint")
    config = json.loads((checkpoint / "config.json").read_text())
    (checkpoint / "config.json").write_text(json.dumps(config | {"dim_model": 32}))
    with pytest.raises(ValueError, match="do not fit the config"):
        load_policy(str(checkpoint))

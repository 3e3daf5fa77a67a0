"""LeRobot's own commands, as a user runs them: train, resume, fine-tune and evaluate."""

import json
import os
import re

import numpy as np
import pytest
import torch
import warm_python
import yaml
from safetensors.torch import load_file
from short_splits import OF_PROGRAMS, SESSIONS

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.evaluation.episode_files import read_episodes
from kitchen_prefs_experiments.recipes import recipe_file

DATASET = "dishwasher-train-p2-d3-v1"
TRAIN = "lerobot.scripts.lerobot_train"
EVAL = "lerobot.scripts.lerobot_eval"
# A small TTP, so that a step takes milliseconds.
SMALL_TTP = ("--policy.dim_pose=16", "--policy.dim_extents=8", "--policy.dim_time=4")
TRAINED = "One more is trained."
TRAIN_ALL = f"""
import json
import sys

from lerobot.scripts.lerobot_train import main

for command in json.loads(sys.argv[1]):
    sys.argv[1:] = command
    main()
    print({TRAINED!r}, file=sys.stderr)
"""
COMMON = ("--policy.device=cpu", "--policy.push_to_hub=false", "--num_workers=0", "--log_freq=1")


@pytest.fixture(scope="session")
def home(made_once):
    """A home with a small data set to train on."""

    def fill(folder):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("HF_LEROBOT_HOME", str(folder))
            make_dataset(DATASET)

    return made_once("lerobot_home", fill)


def run(home, module, *arguments, **variables):
    environment = (
        os.environ
        | variables
        | {
            "HF_LEROBOT_HOME": str(home),
            "HF_DATASETS_CACHE": str(home / "cache"),
            "HF_HUB_OFFLINE": "1",
            "OMP_NUM_THREADS": "1",
        }
    )
    done = warm_python.run("-m", module, *arguments, env=environment, cwd=home)
    assert done.returncode == 0, done.stderr[-3000:]
    return done.stderr + done.stdout


def evaluate(home, policy, out):
    """Roll a policy out on six sessions; what came of it."""
    command = ("evaluate", *policy, "--split=noisy", f"--out={out}")
    run(home, "kitchen_prefs.cli", *command, PYTHONPATH=str(OF_PROGRAMS))
    assert len(read_episodes(out / "noisy.jsonl")) == SESSIONS
    return json.loads((out / "noisy.json").read_text())


@pytest.fixture(scope="session")
def trained(home, made_once):
    """A run of four steps that saved a checkpoint after two."""

    def fill(folder):
        data = f"--dataset.repo_id=kitchen_prefs/{DATASET}"
        sizes = (*SMALL_TTP, "--batch_size=4", "--steps=4", "--save_freq=2")
        output = f"--output_dir={folder / 'run'}"
        log = run(home, TRAIN, "--policy.type=ttp", data, output, *sizes, *COMMON)
        assert "step:4" in log

    return made_once("lerobot_run", fill) / "run"


@pytest.mark.lerobot
@pytest.mark.slow
def test_ttp_resumes_where_it_stopped(home, trained):
    config = trained / "checkpoints" / "last" / "pretrained_model" / "train_config.json"
    log = run(home, TRAIN, f"--config_path={config}", "--resume=true", "--steps=6")
    assert "step:6" in log
    assert "step:4 " not in log
    step = json.loads((trained / "checkpoints/last/training_state/training_step.json").read_text())
    assert step["step"] == 6


@pytest.mark.lerobot
@pytest.mark.slow
def test_ttp_fine_tunes_from_a_checkpoint(home, trained):
    log = run(
        home,
        TRAIN,
        f"--policy.path={trained}/checkpoints/000002/pretrained_model",
        f"--dataset.repo_id=kitchen_prefs/{DATASET}",
        f"--output_dir={home / 'fine'}",
        "--batch_size=4",
        "--steps=2",
        *COMMON,
    )
    assert "step:2" in log


@pytest.mark.lerobot
@pytest.mark.slow
def test_lerobot_eval_rolls_out_a_checkpoint(home, trained):
    out = home / "eval"
    run(
        home,
        EVAL,
        f"--policy.path={trained}/checkpoints/000004/pretrained_model",
        "--env.type=kitchen_prefs",
        "--env.task=val",
        "--eval.n_episodes=1",  # of each preference
        "--eval.batch_size=1",
        "--policy.device=cpu",
        f"--output_dir={out}",
    )
    info = json.loads((out / "eval_info.json").read_text())
    assert info["overall"]["n_episodes"] == 7
    assert [task["task_id"] for task in info["per_task"]] == list(range(7))


@pytest.mark.lerobot
@pytest.mark.slow
def test_evaluate_rolls_out_a_checkpoint_and_the_expert(home, trained):
    checkpoint = f"--policy.path={trained}/checkpoints/000004/pretrained_model"
    for policy in ((checkpoint,), ("--policy.type=rules", "--policy.rule=expert")):
        evaluate(home, policy, home / policy[-1].replace("/", "-"))


@pytest.mark.lerobot
@pytest.mark.slow
def test_lerobot_eval_gives_the_expert_full_success(home):
    run(
        home,
        EVAL,
        "--policy.type=rules",
        "--policy.rule=expert",
        "--env.type=kitchen_prefs",
        "--env.track=privileged",
        "--env.task=unseen_both",
        "--eval.n_episodes=1",
        "--eval.batch_size=1",
        f"--output_dir={home / 'expert'}",
    )
    info = json.loads((home / "expert" / "eval_info.json").read_text())
    assert info["overall"]["pc_success"] == 100


@pytest.mark.lerobot
@pytest.mark.slow
def test_lerobots_act_trains_and_rolls_out_unchanged(home):
    train_and_roll_out(home, "act", "--policy.dim_model=32", "--policy.dim_feedforward=32")


@pytest.mark.lerobot
@pytest.mark.slow
def test_lerobots_diffusion_trains_and_rolls_out_unchanged(home):
    pytest.importorskip("diffusers", reason="wants `uv run --extra diffusion`")
    small = ("--policy.down_dims=[16, 32]", "--policy.num_inference_steps=2")
    train_and_roll_out(home, "diffusion", *small)


@pytest.mark.lerobot
@pytest.mark.slow
def test_ttp_trains_and_rolls_out_on_the_final_state_alone(home):
    train_and_roll_out(home, "ttp_final", *SMALL_TTP, "--policy.dim_feedforward=32")


def train_and_roll_out(home, recipe, *small):
    config = f"--config_path={recipe_file(recipe)}"
    data, output = f"--dataset.repo_id=kitchen_prefs/{DATASET}", f"--output_dir={home / recipe}"
    log = run(home, TRAIN, config, data, output, *small, "--batch_size=4", "--steps=2", *COMMON)
    assert "step:2" in log
    policy = f"--policy.path={home / recipe / 'checkpoints' / 'last' / 'pretrained_model'}"
    evaluate(home, (policy,), home / recipe / "evaluation")


@pytest.mark.lerobot
@pytest.mark.slow
def test_the_graph_network_resumes_and_rolls_out_on_the_privileged_track(home):
    recipe = f"--config_path={recipe_file('gnn_tuned')}"
    data, output = f"--dataset.repo_id=kitchen_prefs/{DATASET}", f"--output_dir={home / 'gnn'}"
    sizes = ("--policy.dim=16", "--batch_size=4", "--steps=2")
    assert "step:2" in run(home, TRAIN, recipe, data, output, *sizes, *COMMON)
    checkpoint = home / "gnn" / "checkpoints" / "last" / "pretrained_model"
    config = f"--config_path={checkpoint / 'train_config.json'}"
    assert "step:3" in run(home, TRAIN, config, "--resume=true", "--steps=3")
    summary = evaluate(home, (f"--policy.path={checkpoint}",), home / "gnn-evaluation")
    assert summary["conditions"]["track"] == "privileged"


@pytest.mark.lerobot
@pytest.mark.slow
def test_the_recipes_train(home):
    # ttp_plus goes on from ttp_quick. One start of LeRobot trains them all.
    recipes = ("ttp_quick", "ttp_plus", "ttp_paper", "gnn_paper")
    commands = [
        (
            f"--config_path={recipe_file(recipe)}",
            f"--dataset.repo_id=kitchen_prefs/{DATASET}",
            f"--output_dir=outputs/{recipe}",
            "--batch_size=4",
            "--steps=2",
            "--log_freq=1",
        )
        for recipe in recipes
    ]
    (home / "train_all.py").write_text(TRAIN_ALL)
    log = run(home, "train_all", json.dumps(commands))
    of_recipes = log.split(TRAINED)[:-1]
    assert len(of_recipes) == len(recipes)
    for of_recipe in of_recipes:
        assert "step:2" in of_recipe
        assert "pick_accuracy:" in of_recipe


@pytest.mark.lerobot
@pytest.mark.slow
def test_mixed_precision_trains_weights_of_float32(home):
    log = run(
        home,
        TRAIN,
        "--policy.type=ttp",
        "--policy.dtype=bfloat16",
        f"--dataset.repo_id=kitchen_prefs/{DATASET}",
        f"--output_dir={home / 'mixed'}",
        *SMALL_TTP,
        "--batch_size=4",
        "--steps=2",
        *COMMON,
    )
    losses = [float(loss) for loss in re.findall(r"loss:(\S+)", log)]
    assert len(losses) == 2
    assert np.isfinite(losses).all()
    weights = load_file(home / "mixed/checkpoints/000002/pretrained_model/model.safetensors")
    assert {weight.dtype for weight in weights.values()} == {torch.float32}


def test_ttp_final_is_ttp_quick_with_another_prompt():
    names = ("ttp_quick", "ttp_final")
    quick, final = (yaml.safe_load(recipe_file(name).read_text()) for name in names)
    assert quick["policy"].pop("prompt_tokens") == "chosen"
    assert final["policy"].pop("prompt_tokens") == "final"
    assert final.pop("steps") == 3 * quick.pop("steps")
    assert final.pop("save_freq") == 2 * quick.pop("save_freq")
    assert quick == final

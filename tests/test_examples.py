"""The example policy: a package of its own, from its installation to a submission."""

import json
import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
import torch
from safetensors.torch import load_file
from short_splits import OF_PROGRAMS

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.evaluation.episode_files import read_episodes

pytestmark = [pytest.mark.xdist_group("examples"), pytest.mark.lerobot, pytest.mark.slow]

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "lerobot_policy_deepsets"
DATASET = "dishwasher-train-p2-d3-v1"  # two preferences, three demonstrations each


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    """The Python of an environment that has this one's packages, and the example installed."""
    environment = tmp_path_factory.mktemp("environment") / "venv"
    subprocess.run(["uv", "venv", "-q", "--python", sys.executable, environment], check=True)
    python = environment / "bin" / "python"
    (site,) = environment.glob("lib/*/site-packages")
    here = sysconfig.get_path("purelib")
    (site / "packages_of_the_tests.pth").write_text(f"import site; site.addsitedir({here!r})\n")
    install = ("--no-deps", "--no-build-isolation", "--offline", EXAMPLE)
    subprocess.run(["uv", "pip", "install", "-q", "--python", python, *install], check=True)
    return python


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    home = tmp_path_factory.mktemp("home")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(home))
        make_dataset(DATASET)
    return home


@pytest.fixture(scope="module")
def run(python, home):
    """Runs a module in that environment, outside the repository."""

    def run(module, *arguments):
        environment = os.environ | {
            "HF_LEROBOT_HOME": str(home),
            "HF_DATASETS_CACHE": str(home / "cache"),
            "HF_HUB_OFFLINE": "1",
            "OMP_NUM_THREADS": "1",
            "PYTHONPATH": str(OF_PROGRAMS),
        }
        command = [python, "-m", module, *arguments]
        done = subprocess.run(
            command, env=environment, cwd=home, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr[-3000:]
        return done.stdout

    return run


@pytest.fixture(scope="module")
def trained(run, home):
    """A run of four steps, with a checkpoint after two."""
    run(
        "lerobot.scripts.lerobot_train",
        *("--policy.type=deepsets", "--policy.device=cpu", "--policy.push_to_hub=false"),
        *(f"--dataset.repo_id=kitchen_prefs/{DATASET}", "--batch_size=8", "--num_workers=0"),
        *("--steps=4", "--save_freq=2", "--log_freq=2", "--env_eval_freq=0"),
        "--output_dir=run",
    )
    return home / "run"


def weights(checkpoint):
    return load_file(checkpoint / "pretrained_model" / "model.safetensors")


def test_the_example_is_short():
    modules = EXAMPLE.rglob("*.py")
    assert sum(len(module.read_text().splitlines()) for module in modules) <= 150


def test_the_page_shows_the_examples_processor():
    page = (ROOT / "docs" / "bring_your_policy.md").read_text()
    assert (EXAMPLE / "lerobot_policy_deepsets" / "processor_deepsets.py").read_text() in page


def test_a_resumed_training_repeats_an_unbroken_one(run, trained):
    first, unbroken = (weights(trained / "checkpoints" / step) for step in ("000002", "000004"))
    run(
        "lerobot.scripts.lerobot_train",
        "--config_path=run/checkpoints/000002/pretrained_model/train_config.json",
        "--resume=true",
    )
    resumed = weights(trained / "checkpoints" / "000004")
    assert any(not torch.equal(first[name], resumed[name]) for name in resumed)
    for name, weight in resumed.items():
        assert torch.equal(weight, unbroken[name]), name


def test_it_is_selected_evaluated_and_submitted(run, trained, home):
    run("kitchen_prefs.cli", "select", "run")
    selection = json.loads((trained / "selection.json").read_text())
    policy = f"--policy.path=run/{selection['best']}"
    run("kitchen_prefs.cli", "evaluate", policy, "--split=seen", "--out=evaluation")
    assert len(read_episodes(home / "evaluation" / "seen.jsonl")) == 6
    named = ("--name=Deep sets", "--track=standard", "--out=submission")
    run("kitchen_prefs.cli", "leaderboard", "submit", policy, *named)
    plugin = json.loads((home / "submission/submission.json").read_text())["policy"]["plugin"]
    assert (plugin["distribution"], plugin["version"]) == ("lerobot_policy_deepsets", "0.1.0")
    score = run("kitchen_prefs.cli", "leaderboard", "score", "submission", "--format=json")
    assert "Deep sets" in score

"""The command `train`: a recipe by name."""

import pytest
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line
from kitchen_prefs_experiments.recipes import recipe_file

SMALL = "kitchen_prefs/dishwasher-train-p1-d1-v1"


def run(*arguments):
    return CliRunner().invoke(command_line(), list(map(str, arguments)))


def test_train_makes_the_data_and_starts_lerobot_train(home, lerobot_train):
    fake = lerobot_train(20)
    out = home / "run"
    options = (f"--dataset.repo_id={SMALL}", "--steps=20")
    done = run("train", "--recipe=ttp_quick", f"--out={out}", *options)
    assert done.exit_code == 0, done.exception
    assert (home / SMALL).is_dir()
    config = f"--config_path={recipe_file('ttp_quick')}"
    assert fake.calls == [[config, *options, f"--output_dir={out}"]]
    command, checkpoint = done.stdout.splitlines()
    assert command == f"lerobot-train {config} --output_dir={out} {' '.join(options)}"
    assert checkpoint == f"The last checkpoint is {out}/checkpoints/last/pretrained_model."


def test_a_data_set_of_another_owner_is_left_to_lerobot(home, lerobot_train):
    fake = lerobot_train(20)
    options = ("--dataset.repo_id=ada/dishes", "--steps=20")
    assert run("train", "--recipe=act", f"--out={home / 'run'}", *options).exit_code == 0
    assert len(fake.calls) == 1
    assert not (home / "ada").exists()


@pytest.mark.parametrize(
    ("recipe", "said"),
    [
        ("ttp_quik", "Did you mean 'ttp_quick'"),
        ("gnn_rl", "kitchen-prefs reinforce --recipe=gnn_rl"),
    ],
)
def test_a_recipe_that_cannot_be_trained_is_said_before_anything_runs(
    home, lerobot_train, recipe, said
):
    fake = lerobot_train(20)
    done = run("train", f"--recipe={recipe}", f"--out={home / 'run'}")
    assert said in str(done.exception)
    assert not fake.calls
    assert not (home / "kitchen_prefs").exists()


@pytest.mark.parametrize("command", [["train"], ["checkpoints", "get"], ["checkpoints", "list"]])
def test_each_command_has_an_example(command):
    assert f"kitchen-prefs {' '.join(command)}" in run(*command, "--help").output

"""The data set by its name: LeRobot reads it, and the recipe trains on it."""

import os
import subprocess
import sys

import numpy as np
import pytest
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line
from kitchen_prefs.datasets.columns import SETS, read_columns
from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.datasets.manifest import read_manifest
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE, STATE
from kitchen_prefs.instances import IS_PLACE
from kitchen_prefs_experiments.checkpoints import checkpoints_folder
from kitchen_prefs_experiments.recipes import recipe_file, training_data
from kitchen_prefs_robot.task import dataset
from kitchen_prefs_robot.task.preferences import LABELS
from kitchen_prefs_robot.task.sessions import DISHES, make_session

SESSIONS = 12
FINGERPRINT = "dd08c759f0dd4481bdd12f591750689aa02d368811a50eb7e8ac081b83ea9c96"
PREFERENCES = len(LABELS["train"])


@pytest.fixture(scope="module")
def home(made_once):
    """A home with the first sessions of the data set."""

    def fill(folder):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("HF_LEROBOT_HOME", str(folder))
            patch.setattr(dataset, "SESSIONS", SESSIONS)
            patch.setattr(dataset, "_demonstrations", lambda: map(dataset.as_recorded, some()))
            dataset.make_dataset()

    return made_once("drawers_home", fill)


def some():
    """Two sessions of each of six preferences, so that each has a prompt in the other."""
    labels = dataset.SESSIONS // 2
    turns = (0, PREFERENCES)
    return [make_session("train", turn + index) for turn in turns for index in range(labels)]


@pytest.fixture
def root(home):
    return home / "kitchen_prefs" / dataset.NAME


def test_the_sessions_are_those_that_the_checkpoint_was_trained_on(root):
    assert read_manifest(dataset.NAME, root)["fingerprint"] == FINGERPRINT


def test_the_columns_say_the_same_as_the_sets(root):
    columns = read_columns(root)
    assert read_manifest(dataset.NAME, root)["episodes"] == SESSIONS
    state, summary = columns["observation.state"], columns["observation.environment_state"]
    opened = state[:, [STATE.index("bottom rack (m)"), STATE.index("top rack (m)")]]
    assert (opened.astype(bool).sum(axis=1) <= 1).all()
    holds = (columns[SETS][..., IS_PLACE] > 0).any(axis=1)
    assert (state[:, 3:10].sum(axis=1) == holds).all()
    assert (summary[:, ENVIRONMENT_STATE.index("a free placement exists")] == holds).all()
    on_counter = summary[:, :7].sum(axis=1)
    starts = columns["frame_index"] == 0
    assert on_counter[starts].tolist() == [4] * 6 + [5] * 6
    assert on_counter[columns["next.done"]].tolist() == [0] * SESSIONS
    assert columns["next.reward"].sum() == 2 * on_counter[starts].sum()


def test_the_full_data_set_has_each_preference_with_each_number_of_dishes():
    sessions = [make_session("train", index) for index in range(0, dataset.SESSIONS, PREFERENCES)]
    assert tuple(len(session.start.dishes) for session in sessions) == DISHES["train"]
    assert len({session.label for session in sessions}) == 1


@pytest.mark.lerobot
def test_lerobot_reads_it_as_demonstrations(root):
    from lerobot.datasets import LeRobotDatasetMetadata

    meta = LeRobotDatasetMetadata(f"kitchen_prefs/{dataset.NAME}", root=root)
    store = DemonstrationStore.read(meta, chosen_only=True)
    assert len(np.unique(store.preference)) == SESSIONS / 2
    assert np.bincount(store.preference)[store.preference].tolist() == [2] * SESSIONS


def test_training_without_it_says_how_it_is_made(tmp_path, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    arguments = ["train", "--recipe=ttp_drawers", f"--out={tmp_path / 'run'}"]
    error = CliRunner().invoke(command_line(), arguments).exception
    assert "`kitchen-prefs robot data` makes it" in str(error)


@pytest.mark.lerobot
@pytest.mark.slow
def test_the_recipe_trains_through_lerobot_train(home, tmp_path):
    assert training_data("ttp_drawers") == f"kitchen_prefs/{dataset.NAME}"
    environment = {"HF_LEROBOT_HOME": str(home), "HF_DATASETS_CACHE": str(tmp_path / "cache")}
    command = [sys.executable, "-m", "lerobot.scripts.lerobot_train"]
    options = (
        f"--config_path={recipe_file('ttp_drawers')}",
        f"--policy.path={checkpoints_folder() / 'ttp_quick'}",
        f"--output_dir={tmp_path / 'run'}",
        *("--steps=2", "--save_freq=2", "--log_freq=1", "--num_workers=0", "--batch_size=4"),
    )
    done = subprocess.run(
        [*command, *options],
        env=os.environ | environment | {"HF_HUB_OFFLINE": "1"},
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    assert (tmp_path / "run/checkpoints/000002/pretrained_model/model.safetensors").is_file()

"""Checkpoints by name: verified, copied, downloaded."""

import json
import shutil

import pytest
from hub_server import Commit, Repository, kitchen_prefs
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line
from kitchen_prefs_experiments import checkpoints
from kitchen_prefs_experiments.checkpoints import checkpoints_folder, find_checkpoint, read_manifest

REPO_ID = "kitchen_prefs/gnn_rl"


def run(*arguments):
    return CliRunner().invoke(command_line(), list(map(str, arguments)))


@pytest.fixture
def copies(tmp_path, monkeypatch):
    """A folder of checkpoints with the manifest and one checkpoint, in place of the committed."""
    folder = tmp_path / "checkpoints"
    shutil.copytree(checkpoints_folder() / "gnn_rl", folder / "gnn_rl")
    shutil.copy(checkpoints_folder() / "manifest.json", folder)
    monkeypatch.setattr(checkpoints, "checkpoints_folder", lambda: folder)
    return folder


@pytest.fixture
def model(hub):
    """The files of the checkpoint gnn_rl, on a hub."""
    source = checkpoints_folder() / "gnn_rl"
    files = {path.name: path.read_bytes() for path in source.iterdir()}
    repository = Repository({"visibility": "public"}, [Commit("", "", files)])
    hub.repositories["models", REPO_ID] = repository
    return files


def test_the_manifest_has_the_committed_checkpoints():
    recorded = {folder.name: checkpoints._digests(folder) for folder in folders()}
    assert read_manifest() == recorded, "`kitchen-prefs checkpoints record` writes it"


def folders():
    return sorted(path for path in checkpoints_folder().iterdir() if path.is_dir())


def test_list_names_all_and_says_which_are_on_the_hub(copies):
    lines = dict(line.split(maxsplit=1) for line in run("checkpoints", "list").stdout.splitlines())
    assert list(lines) == list(read_manifest())
    assert {name for name, where in lines.items() if where == "installed"} == {"gnn_rl"}
    assert lines["act"] == "on the hub"


def test_get_prints_the_folder(copies, tmp_path):
    assert run("checkpoints", "get", "gnn_rl").stdout == f"{copies / 'gnn_rl'}\n"
    copy = tmp_path / "mine"
    assert run("checkpoints", "get", "gnn_rl", "--out", copy).stdout == f"{copy}\n"
    assert {path.name for path in copy.iterdir()} >= set(read_manifest()["gnn_rl"])
    assert "mine exists" in str(run("checkpoints", "get", "gnn_rl", "--out", copy).exception)


def test_a_wrong_name_suggests_the_nearest():
    with pytest.raises(ValueError, match="Did you mean 'gnn_rl'"):
        find_checkpoint("gnn_lr")


@pytest.mark.parametrize("damage", ["changed", "missing"])
def test_a_checkpoint_that_differs_from_its_hash_is_refused(copies, damage):
    weights = copies / "gnn_rl" / "model.safetensors"
    if damage == "changed":
        weights.write_bytes(weights.read_bytes()[:-1] + b"x")
    else:
        weights.unlink()
    with pytest.raises(ValueError, match=r"model\.safetensors is not the file"):
        find_checkpoint("gnn_rl")


def test_record_writes_the_hashes_of_what_is_there(copies):
    (copies / "gnn_rl" / "config.json").write_text("{}")
    assert run("checkpoints", "record").exit_code == 0
    manifest = json.loads((copies / "manifest.json").read_text())
    assert list(manifest) == ["gnn_rl"]
    assert find_checkpoint("gnn_rl") == copies / "gnn_rl"


@pytest.mark.slow
def test_what_is_not_installed_comes_from_the_hub_verified(hub, model):
    done = kitchen_prefs(hub, "checkpoints", "get", "gnn_rl", f"--repo-id={REPO_ID}")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"{hub.folder}/home/hub/models--kitchen_prefs--gnn_rl/")

    hub.repositories["models", REPO_ID].commits.append(
        Commit("", "", model | {"config.json": b"{}"})
    )
    done = kitchen_prefs(hub, "checkpoints", "get", "gnn_rl", f"--repo-id={REPO_ID}")
    assert done.returncode == 1
    assert "config.json is not the file that the manifest" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    ("repo_id", "environment", "said"),
    [
        ("ada/none", {}, "The hub has no ada/none"),
        ("none", {}, "No repository can be named 'none'"),
        ("ada/none", {"HF_HUB_OFFLINE": "1"}, "No hub answers for ada/none; unset HF_HUB_OFFLINE"),
        ("ada/none", {"HF_ENDPOINT": "http://127.0.0.1:9"}, "No hub answers for ada/none"),
    ],
)
def test_a_hub_without_it_is_one_sentence(hub, repo_id, environment, said):
    done = kitchen_prefs(hub, "checkpoints", "get", "gnn_rl", f"--repo-id={repo_id}", **environment)
    assert done.returncode == 1
    assert said in done.stderr.splitlines()[-1]  # the client may report its attempts before
    assert "Traceback" not in done.stderr

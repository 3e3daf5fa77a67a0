"""Checkpoints by name: verified and copied."""

import json
import shutil

import pytest
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line
from kitchen_prefs_experiments import checkpoints
from kitchen_prefs_experiments.checkpoints import checkpoints_folder, find_checkpoint, read_manifest


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


def test_the_manifest_has_the_committed_checkpoints():
    recorded = {folder.name: checkpoints._digests(folder) for folder in folders()}
    assert read_manifest() == recorded, "`kitchen-prefs checkpoints record` writes it"


def folders():
    return sorted(path for path in checkpoints_folder().iterdir() if path.is_dir())


def test_list_names_all():
    assert run("checkpoints", "list").stdout.splitlines() == list(read_manifest())


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

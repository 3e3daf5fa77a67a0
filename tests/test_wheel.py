"""The wheel: what it installs, and what it must not."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.xdist_group("wheel")  # one fixture of the module serves all

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "kitchen_prefs",
    "lerobot_policy_kitchen_prefs",
    "kitchen_prefs_experiments",
    "kitchen_prefs_leaderboard",
}


@pytest.fixture(scope="module")
def names(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    (wheel,) = folder.glob("lerobot_policy_kitchen_prefs-*.whl")
    return set(zipfile.ZipFile(wheel).namelist())


def test_no_generic_name_is_installed(names):
    top = {name.split("/")[0] for name in names}
    assert {name for name in top if not name.endswith(".dist-info")} == PACKAGES


def test_data_and_recipes_are_installed(names):
    assert "kitchen_prefs/simulation/placements.npz" in names
    assert "kitchen_prefs/datasets/fingerprints.json" in names
    assert "kitchen_prefs/datasets/card.md" in names
    assert "kitchen_prefs_experiments/recipes/ttp_quick.yaml" in names
    assert "kitchen_prefs_leaderboard/page/templates/page.html" in names

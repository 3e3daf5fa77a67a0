"""The wheel: what it installs, and that it works in an empty folder without the repository."""

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from short_splits import OF_PROGRAMS

pytestmark = pytest.mark.xdist_group("wheel")  # one fixture of the module serves all

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "kitchen_prefs",
    "lerobot_policy_kitchen_prefs",
    "kitchen_prefs_demonstrations",
    "kitchen_prefs_experiments",
    "kitchen_prefs_leaderboard",
    "kitchen_prefs_robot",
}
MOST_BYTES = 40e6


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    (wheel,) = folder.glob("lerobot_policy_kitchen_prefs-*.whl")
    return wheel


@pytest.fixture(scope="module")
def names(wheel):
    return set(zipfile.ZipFile(wheel).namelist())


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """The wheel's content, in a folder that comes first on the path of `run`."""
    folder = tmp_path_factory.mktemp("installed")
    zipfile.ZipFile(wheel).extractall(folder)
    return folder


@pytest.fixture
def run(installed, tmp_path, monkeypatch):
    """Runs the installed `kitchen-prefs` in an empty folder, and checks that it writes there."""
    home = tmp_path / "home"
    monkeypatch.setenv("HF_LEROBOT_HOME", str(home))
    empty = tmp_path / "empty"
    empty.mkdir()

    def run(*arguments, path=()):
        path = os.pathsep.join(map(str, (installed, *path)))
        before = set(content(installed))
        done = subprocess.run(
            [sys.executable, "-m", "kitchen_prefs.cli", *arguments],
            cwd=empty,
            env=os.environ | {"PYTHONPATH": path},
            capture_output=True,
            text=True,
            check=False,
        )
        assert set(content(installed)) == before
        assert str(ROOT) not in done.stdout
        return done

    run.folder = empty
    return run


def content(folder):
    return (path for path in folder.rglob("*") if "__pycache__" not in path.parts)


def test_no_generic_name_is_installed(names):
    top = {name.split("/")[0] for name in names}
    assert {name for name in top if not name.endswith(".dist-info")} == PACKAGES


def test_data_recipes_and_checkpoints_are_installed(names):
    assert "kitchen_prefs/simulation/placements.npz" in names
    assert "kitchen_prefs/datasets/fingerprints.json" in names
    assert {f"kitchen_prefs/datasets/{card}.md" for card in ("card", "people_card")} <= set(names)
    assert "kitchen_prefs/web/templates/kitchen.js" in names
    assert "kitchen_prefs_experiments/recipes/ttp_quick.yaml" in names
    assert "kitchen_prefs_experiments/checkpoints/manifest.json" in names
    assert "kitchen_prefs_experiments/checkpoints/ttp_paper/model.safetensors" in names
    assert "kitchen_prefs_leaderboard/page/templates/page.html" in names
    assert "kitchen_prefs_demonstrations/page/templates/ttp.js" in names


def test_it_stays_small(wheel):
    assert wheel.stat().st_size < MOST_BYTES


@pytest.mark.lerobot
@pytest.mark.slow
def test_the_quickstart_runs_and_shows_no_traceback(run, installed, monkeypatch):
    monkeypatch.setenv("SESSIONS_OF_SHORT_SPLITS", "22")  # the last one is drawn
    recipe = installed / "kitchen_prefs_experiments" / "recipes" / "ttp_quick.yaml"
    text = recipe.read_text()
    recipe.write_text(
        text.replace("steps: 1000", "steps: 2")
        .replace("save_freq: 250", "save_freq: 2")
        .replace("log_freq: 50", "log_freq: 1")
    )
    done = run("quickstart", path=[OF_PROGRAMS])
    recipe.write_text(text)
    assert done.returncode == 0, done.stderr
    for output in (done.stdout, done.stderr):
        assert "torchcodec" not in output
        assert "Traceback" not in output
    assert "uv run" not in done.stdout
    made = {path.name for path in (run.folder / "outputs" / "quickstart").iterdir()}
    assert made >= {"table.md", "learning_curve.png", "start.png", "end.png", "episode.gif"}
    log = (run.folder / "outputs" / "quickstart" / "train.log").read_text()
    assert "Traceback" not in log


@pytest.mark.lerobot
@pytest.mark.slow
def test_a_checkpoint_is_found_by_name_and_a_policy_submitted(run):
    short = {"path": [OF_PROGRAMS]}
    checkpoint = run("checkpoints", "get", "ttp_quick").stdout.strip()
    evaluate = ("evaluate", f"--policy.path={checkpoint}", "--split=seen", "--out=seen")
    policy = ("--policy.type=rules", "--policy.rule=symbolic")
    submit = ("leaderboard", "submit", "--name=Mine", "--track=standard", "--out=mine", *policy)
    for command in (evaluate, submit, ("leaderboard", "score", "mine")):
        done = run(*command, **short)
        assert done.returncode == 0, done.stderr
    assert "Mine" in done.stdout


def test_results_say_where_they_are_looked_for(run):
    done = run("results")
    assert done.returncode == 1
    assert done.stderr.startswith("kitchen-prefs: docs/results holds no results;")
    assert list(run.folder.iterdir()) == []

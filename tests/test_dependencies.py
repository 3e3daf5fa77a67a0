"""What the package asks for: ranges for whoever installs it, exact versions for the figures."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.version import Version

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
EXTRAS = PROJECT["project"]["optional-dependencies"]
REQUIRED = [Requirement(text) for text in PROJECT["project"]["dependencies"]]
OPTIONAL = [Requirement(text) for texts in EXTRAS.values() for text in texts]
PINS = [
    line
    for line in (ROOT / "constraints.txt").read_text().splitlines()
    if line and not line.startswith("#")
]
VERSIONS = dict(pin.split("==") for pin in PINS)

WITHOUT_MUJOCO = """\
import sys
sys.modules["mujoco"] = None  # Python then finds no such package
from kitchen_prefs.cli import main
{code}
"""


def run_without_mujoco(code, *arguments):
    program = WITHOUT_MUJOCO.format(code=code)
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False
    )


@pytest.mark.xdist_group("a group")
def test_tests_of_a_group_run_in_one_worker(request, worker_id):
    """pytest-xdist appends the group's name to the test's; where it cannot, it groups nothing."""
    assert worker_id == "master" or request.node.nodeid.endswith("@a group")


def test_uv_and_pip_are_given_the_same_exact_versions():
    assert PROJECT["tool"]["uv"]["constraint-dependencies"] == PINS


@pytest.mark.parametrize("requirement", [*REQUIRED, *OPTIONAL], ids=str)
def test_a_dependency_is_a_range_that_holds_the_exact_version(requirement):
    assert "==" not in {part.operator for part in requirement.specifier}
    assert Version(VERSIONS[requirement.name]) in requirement.specifier


def test_mujoco_comes_with_the_scene_alone():
    assert "mujoco" not in {requirement.name for requirement in REQUIRED}
    assert [Requirement(text).name for text in EXTRAS["scene"]] == ["mujoco"]


def test_the_kitchen_runs_without_mujoco():
    done = run_without_mujoco(
        "import gymnasium\n"
        "env = gymnasium.make('kitchen_prefs/DishwasherLoading-v0', split='seen')\n"
        "env.reset(seed=0)\n"
        "_, reward, *_ = env.step(env.action_space.sample())\n"
        "print(reward)\n"
        "import kitchen_prefs.rendering.plan"
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("code", "arguments"),
    [
        ("main()", ["physics", "make-placements"]),
        ("main()", ["physics", "check-placements"]),
        ("import kitchen_prefs.rendering.renderer", []),
    ],
)
def test_pictures_and_physics_name_the_extra(code, arguments):
    done = run_without_mujoco(code, *arguments)
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert "pip install 'lerobot_policy_kitchen_prefs[scene]'" in last

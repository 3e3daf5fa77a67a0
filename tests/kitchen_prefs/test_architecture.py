"""The arrows of the architecture: who may import whom."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = {
    "kitchen_prefs": ROOT / "kitchen_prefs",
    "lerobot_policy_kitchen_prefs": ROOT / "policies/lerobot_policy_kitchen_prefs",
    "kitchen_prefs_leaderboard": ROOT / "leaderboard/kitchen_prefs_leaderboard",
}
# scene -> kitchen -> {expert, sessions} -> {environment, datasets} -> rollouts; each layer may
# import those before it.
LAYERS = (
    ("preferences", "instances", "splits"),
    ("scene",),
    ("kitchen",),
    ("expert",),
    ("sessions", "observations", "rewards", "demonstrations", "metrics"),
    ("environment", "environment_config", "datasets"),
)


def imports(path):
    """The modules that a file imports, at its top or inside functions."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def files(package):
    return sorted(PACKAGES[package].rglob("*.py"))


@pytest.mark.parametrize("path", files("kitchen_prefs"), ids=lambda p: str(p.relative_to(ROOT)))
def test_the_benchmark_imports_no_policy_and_no_leaderboard(path):
    above = ("lerobot_policy_kitchen_prefs", "kitchen_prefs_leaderboard")
    assert not [name for name in imports(path) if name.startswith(above)]


def test_layers_import_only_those_before_them():
    layer_of = {module: i for i, modules in enumerate(LAYERS) for module in modules}
    checked = 0
    for path in files("kitchen_prefs"):
        module = path.relative_to(PACKAGES["kitchen_prefs"]).parts[0].removesuffix(".py")
        if module not in layer_of or path.name == "commands.py":
            continue  # commands stand on top of everything
        for name in imports(path):
            parts = name.split(".")
            if parts[0] == "kitchen_prefs" and len(parts) > 1 and parts[1] in layer_of:
                checked += 1
                assert layer_of[parts[1]] <= layer_of[module], f"{path.name} imports {name}"
    assert checked > 30


def test_only_the_scene_knows_mujoco():
    for path in files("kitchen_prefs"):
        if "scene" not in path.parts:
            assert not [n for n in imports(path) if n.split(".")[0] == "mujoco"], path


def test_the_kitchen_imports_no_lerobot():
    for module in ("kitchen", "expert", "sessions", "environment", "metrics"):
        names = imports(PACKAGES["kitchen_prefs"] / f"{module}.py")
        assert not [name for name in names if name.split(".")[0] in ("lerobot", "torch")]

"""The arrows of the architecture: who may import whom."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = {
    "kitchen_prefs": ROOT / "kitchen_prefs",
    "lerobot_policy_kitchen_prefs": ROOT / "policies/lerobot_policy_kitchen_prefs",
    "kitchen_prefs_leaderboard": ROOT / "leaderboard/kitchen_prefs_leaderboard",
}
# scene -> kitchen -> {expert, sessions} -> {environment, datasets} -> rollouts: every part of the
# benchmark, each after all those that it may import.
ORDER = (
    "files",
    "hub",
    "preferences",
    "instances",
    "actions",
    "splits",
    "recipes",
    "scene",
    "kitchen",
    "expert",
    "sessions",
    "observations",
    "rewards",
    "demonstrations",
    "metrics",
    "play",
    "environment",
    "environment_config",
    "datasets",
    "records",
    "rollouts",
    "checkpoints",
    "actors",
    "evaluator",
    "selection",
    "evaluation",
    "reinforcement",
    "quickstart",
    "reproduction",
    "commands",  # of the scene and of the data sets: they stand on top of everything but the CLI
    "cli",
    "__init__",
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


def part_of(module):
    """The part of ORDER to which a module of kitchen_prefs belongs."""
    parts = module.split(".")
    return "commands" if parts[-1] == "commands" else parts[1] if len(parts) > 1 else "__init__"


def module_of(path):
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts).removesuffix(".__init__")


MODULES = {module_of(path): path for path in files("kitchen_prefs")}


def imported_modules(module):
    """The modules of kitchen_prefs that one of them imports or takes names from."""
    for name in imports(MODULES[module]):
        taken_from = name if name in MODULES else name.rpartition(".")[0]
        if taken_from in MODULES and name != "kitchen_prefs":
            yield taken_from


def test_every_module_has_its_place_in_the_order():
    assert {part_of(module) for module in MODULES} == set(ORDER)


@pytest.mark.parametrize("module", MODULES)
def test_a_module_imports_only_parts_before_its_own(module):
    own = ORDER.index(part_of(module))
    above = [name for name in imported_modules(module) if ORDER.index(part_of(name)) > own]
    assert not above


def test_no_modules_import_each_other():
    graph = {module: set(imported_modules(module)) - {module} for module in MODULES}
    assert len(list(TopologicalSorter(graph).static_order())) == len(MODULES)


def test_only_the_scene_knows_mujoco():
    for path in files("kitchen_prefs"):
        if "scene" not in path.parts:
            assert not [n for n in imports(path) if n.split(".")[0] == "mujoco"], path


def test_the_kitchen_imports_no_lerobot():
    for module in ("kitchen", "expert", "sessions", "environment", "metrics"):
        names = imports(PACKAGES["kitchen_prefs"] / f"{module}.py")
        assert not [name for name in names if name.split(".")[0] in ("lerobot", "torch")]

"""The graph of rooms: which room imports which. A new arrow fails here until it is drawn here."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "kitchen_prefs": ROOT / "kitchen_prefs",
    "lerobot_policy_kitchen_prefs": ROOT / "policies/lerobot_policy_kitchen_prefs",
    "kitchen_prefs_experiments": ROOT / "policies/kitchen_prefs_experiments",
    "kitchen_prefs_demonstrations": ROOT / "demonstrations/kitchen_prefs_demonstrations",
    "kitchen_prefs_leaderboard": ROOT / "leaderboard/kitchen_prefs_leaderboard",
    "kitchen_prefs_robot": ROOT / "robot/kitchen_prefs_robot",
}

# The benchmark, from the bottom up. The nouns that all share are modules, the rooms are folders.
BENCHMARK = {
    "utils": "",
    "preferences": "",
    "instances": "",
    "metrics": "",
    "splits": "utils",
    "simulation": "preferences splits",
    "people": "preferences simulation utils",
    "physics": "people preferences simulation splits utils",
    "rendering": "people physics preferences simulation utils",
    "envs": "instances metrics people preferences rendering simulation splits utils",
    "datasets": "envs instances metrics people preferences rendering simulation splits utils",
    "evaluation": "datasets envs metrics people simulation splits utils",
    "web": "preferences simulation splits",
    "cli": "datasets evaluation physics",
    "__init__": "datasets",
}
# What stands on it. An arrow into the benchmark names its room, one within a package only the room.
POLICIES = {
    "common": (
        "kitchen_prefs.datasets kitchen_prefs.envs kitchen_prefs.instances kitchen_prefs.simulation"
    ),
    "ttp": "common kitchen_prefs.datasets kitchen_prefs.envs kitchen_prefs.instances",
    "ttp_plan": (
        "common ttp kitchen_prefs.datasets kitchen_prefs.envs kitchen_prefs.instances "
        "kitchen_prefs.people kitchen_prefs.simulation"
    ),
    "gnn": (
        "common kitchen_prefs.datasets kitchen_prefs.envs kitchen_prefs.instances "
        "kitchen_prefs.preferences"
    ),
    "rules": (
        "common kitchen_prefs.envs kitchen_prefs.instances kitchen_prefs.people "
        "kitchen_prefs.preferences kitchen_prefs.simulation kitchen_prefs.splits "
        "kitchen_prefs.utils"
    ),
    "__init__": (
        "common gnn rules ttp ttp_plan kitchen_prefs.datasets kitchen_prefs.envs "
        "kitchen_prefs.utils"
    ),
}
EXPERIMENTS = {
    "recipes": "kitchen_prefs.utils",
    "checkpoints": "kitchen_prefs.utils",
    "commands": (
        "checkpoints lerobot_train recipes kitchen_prefs.datasets kitchen_prefs.evaluation"
    ),
    "markdown": "kitchen_prefs.metrics",
    "lerobot_train": "recipes kitchen_prefs.utils",
    "quickstart": (
        "lerobot_train markdown kitchen_prefs.datasets kitchen_prefs.envs "
        "kitchen_prefs.evaluation "
        "kitchen_prefs.metrics kitchen_prefs.rendering kitchen_prefs.splits kitchen_prefs.utils"
    ),
    "reinforcement": (
        "recipes kitchen_prefs.envs kitchen_prefs.evaluation kitchen_prefs.instances "
        "kitchen_prefs.metrics kitchen_prefs.simulation kitchen_prefs.utils"
    ),
    "people": (
        "markdown kitchen_prefs.envs kitchen_prefs.metrics kitchen_prefs.people "
        "kitchen_prefs.rendering kitchen_prefs.simulation kitchen_prefs.utils"
    ),
    "paper": (
        "checkpoints lerobot_train markdown recipes kitchen_prefs.datasets "
        "kitchen_prefs.evaluation "
        "kitchen_prefs.metrics kitchen_prefs.splits kitchen_prefs.utils"
    ),
    "__init__": "",
}
DEMONSTRATIONS = {
    "file_format": "kitchen_prefs.envs kitchen_prefs.simulation kitchen_prefs.utils",
    "kitchens": "kitchen_prefs.simulation kitchen_prefs.splits",
    "replaying": "file_format kitchen_prefs.envs kitchen_prefs.simulation kitchen_prefs.splits",
    "implied_preference": (
        "habits replaying kitchen_prefs.preferences kitchen_prefs.simulation "
        "lerobot_policy_kitchen_prefs.rules"
    ),
    "importing": (
        "implied_preference replaying kitchen_prefs.datasets kitchen_prefs.envs kitchen_prefs.utils"
    ),
    "habits": "replaying kitchen_prefs.preferences kitchen_prefs.simulation",
    "comparison": (
        "habits replaying kitchen_prefs.envs kitchen_prefs.metrics kitchen_prefs.preferences "
        "kitchen_prefs.simulation"
    ),
    "agreement": "comparison replaying kitchen_prefs.metrics",
    "serving": "file_format replaying",
    "page": (
        "kitchens kitchen_prefs.envs kitchen_prefs.evaluation kitchen_prefs.instances "
        "kitchen_prefs.physics kitchen_prefs.preferences kitchen_prefs.rendering "
        "kitchen_prefs.simulation kitchen_prefs.splits kitchen_prefs.web "
        "kitchen_prefs_experiments.checkpoints"
    ),
    "commands": (
        "agreement comparison file_format importing page replaying serving kitchen_prefs.utils"
    ),
    "__init__": "",
}
LEADERBOARD = {
    "submission_format": "kitchen_prefs.envs kitchen_prefs.evaluation kitchen_prefs.utils",
    "plugin_identity": "submission_format",
    "submission_reading": "submission_format kitchen_prefs.evaluation kitchen_prefs.utils",
    "replay": (
        "submission_format submission_reading kitchen_prefs.envs kitchen_prefs.evaluation "
        "kitchen_prefs.instances kitchen_prefs.simulation"
    ),
    "scoring": (
        "replay submission_format submission_reading kitchen_prefs.datasets "
        "kitchen_prefs.evaluation kitchen_prefs.metrics kitchen_prefs.utils"
    ),
    "recording_reading": ("kitchen_prefs.datasets kitchen_prefs.evaluation"),
    "policy_runs": ("submission_format kitchen_prefs.evaluation kitchen_prefs.utils"),
    "submission_writing": (
        "plugin_identity replay submission_format kitchen_prefs.datasets kitchen_prefs.evaluation "
        "kitchen_prefs.utils"
    ),
    "verification": "submission_format kitchen_prefs.utils",
    "judgement": (
        "scoring submission_format verification kitchen_prefs.evaluation kitchen_prefs.metrics "
        "kitchen_prefs.splits"
    ),
    "rerun_plan": "kitchen_prefs.evaluation kitchen_prefs.simulation",
    "reruns": ("judgement rerun_plan scoring verification kitchen_prefs.evaluation"),
    "ranking": (
        "judgement scoring submission_format verification kitchen_prefs.evaluation "
        "kitchen_prefs.metrics"
    ),
    "score_formats": "scoring verification kitchen_prefs.evaluation kitchen_prefs.metrics",
    "hub_upload": "scoring kitchen_prefs.utils",
    "page": (
        "judgement ranking scoring kitchen_prefs.evaluation kitchen_prefs.metrics "
        "kitchen_prefs.utils kitchen_prefs.web"
    ),
    "commands": (
        "hub_upload page policy_runs ranking recording_reading reruns score_formats scoring "
        "submission_format submission_writing verification kitchen_prefs.evaluation "
        "kitchen_prefs.utils"
    ),
    "__init__": "",
}
ROBOT = {
    "task": (
        "kitchen_prefs.datasets kitchen_prefs.envs kitchen_prefs.evaluation "
        "kitchen_prefs.instances kitchen_prefs.metrics kitchen_prefs.preferences "
        "kitchen_prefs.simulation kitchen_prefs.utils"
    ),
    "scene": (
        "kitchen_prefs.physics kitchen_prefs.preferences kitchen_prefs.rendering "
        "kitchen_prefs.simulation kitchen_prefs.utils"
    ),
    "motion": "perception scene kitchen_prefs.rendering",
    "perception": "scene kitchen_prefs.utils",
    "real_to_sim": "perception scene task kitchen_prefs.simulation",
    "demonstrations": (
        "perception real_to_sim scene task kitchen_prefs.datasets kitchen_prefs.instances "
        "kitchen_prefs.simulation kitchen_prefs.utils"
    ),
    "execution": (
        "demonstrations motion perception real_to_sim scene task kitchen_prefs.envs "
        "kitchen_prefs.evaluation kitchen_prefs.metrics "
        "kitchen_prefs.simulation kitchen_prefs.utils"
    ),
    "lerobot": ("demonstrations execution scene kitchen_prefs.envs kitchen_prefs.utils"),
    "commands": (
        "demonstrations execution motion perception scene task kitchen_prefs.evaluation "
        "kitchen_prefs.metrics kitchen_prefs.rendering"
    ),
    "__init__": "",
}


def graph(package, arrows):
    """Room -> the rooms that it may import, all by their full names."""
    full = {room: f"{package}.{room}" for room in arrows}
    return {
        full[room]: {full.get(name, name) for name in targets.split()}
        for room, targets in arrows.items()
    }


ALLOWED = (
    graph("kitchen_prefs", BENCHMARK)
    | graph("lerobot_policy_kitchen_prefs", POLICIES)
    | graph("kitchen_prefs_experiments", EXPERIMENTS)
    | graph("kitchen_prefs_demonstrations", DEMONSTRATIONS)
    | graph("kitchen_prefs_leaderboard", LEADERBOARD)
    | graph("kitchen_prefs_robot", ROBOT)
)


def module_of(package, path):
    relative = path.relative_to(PACKAGES[package]).with_suffix("")
    return ".".join((package, *relative.parts))


MODULES = {
    module_of(package, path): path
    for package, folder in PACKAGES.items()
    for path in sorted(folder.rglob("*.py"))
}
FOLDERS = {
    f"{package}.{path.name}" for package, root in PACKAGES.items() for path in root.glob("*/")
}


def room_of(module):
    """The room of a module: the folder or the file that stands directly in its package."""
    return ".".join(module.split(".")[:2])


def imported_names(module):
    """All that a module imports, at its top or inside functions, by full names."""
    package = module.rpartition(".")[0].split(".")
    for node in ast.walk(ast.parse(MODULES[module].read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parent = package[: len(package) - node.level + 1] if node.level else []
            source = ".".join([*parent, *([node.module] if node.module else [])])
            yield from (f"{source}.{alias.name}" for alias in node.names)


def imported_modules(module):
    """The project's own modules that a module imports or takes names from."""
    for name in imported_names(module):
        for candidate in (name, f"{name}.__init__", name.rpartition(".")[0]):
            if candidate in MODULES or f"{candidate}.__init__" in MODULES:
                yield candidate if candidate in MODULES else f"{candidate}.__init__"
                break


ARROWS = {
    (room_of(module), room_of(imported))
    for module in MODULES
    for imported in imported_modules(module)
    if room_of(module) != room_of(imported)
}


def test_every_room_is_drawn():
    assert {room_of(module) for module in MODULES} == set(ALLOWED)


def test_every_arrow_is_drawn():
    drawn = {(room, target) for room, targets in ALLOWED.items() for target in targets}
    new, gone = sorted(ARROWS - drawn), sorted(drawn - ARROWS)
    assert not new, f"new arrows, draw them here if they are meant: {new}"
    assert not gone, f"arrows that no import needs any more: {gone}"


def test_no_arrow_points_upwards():
    assert list(TopologicalSorter(ALLOWED).static_order())


def test_no_modules_import_each_other():
    own = {module: set(imported_modules(module)) - {module} for module in MODULES}
    assert len(list(TopologicalSorter(own).static_order())) == len(MODULES)


MUJOCO = (
    "kitchen_prefs.physics",
    "kitchen_prefs.rendering",
    "kitchen_prefs_demonstrations.page.kitchen_gltf",
    "kitchen_prefs_robot",
)


@pytest.mark.parametrize("module", MODULES)
def test_only_what_draws_and_the_robot_know_mujoco(module):
    if not module.startswith(MUJOCO):
        assert "mujoco" not in {name.split(".")[0] for name in imported_names(module)}


LEROBOT = ("kitchen_prefs.envs.lerobot_env", "kitchen_prefs.evaluation", "kitchen_prefs.datasets")


def test_nothing_but_the_robot_imports_it():
    ends = {target for room, target in ARROWS if not room.startswith("kitchen_prefs_robot")}
    assert not {room for room in ends if room.startswith("kitchen_prefs_robot")}


@pytest.mark.parametrize("module", [name for name in MODULES if name.startswith("kitchen_prefs.")])
def test_the_kitchen_and_its_environment_import_neither_lerobot_nor_torch(module):
    if not module.startswith(LEROBOT):
        assert not {"lerobot", "torch"} & {name.split(".")[0] for name in imported_names(module)}

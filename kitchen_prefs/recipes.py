"""Where the training recipes lie: YAML files.

`lerobot-train --config_path` takes them, `kitchen-prefs reinforce --recipe` those of reinforcement
learning. They belong to the policies: `policies/recipes/` in a checkout, inside their package in a
wheel.
"""

from importlib.util import find_spec
from pathlib import Path

from kitchen_prefs.splits import suggest

POLICIES = "lerobot_policy_kitchen_prefs"  # looked up, not imported: importing it takes seconds


def recipe_file(name: str) -> Path:
    """The YAML file of a recipe.

    Args:
        name: Such as "ttp_quick".

    Raises:
        ValueError: If there is no such recipe; the message suggests the nearest.
    """
    package = Path(find_spec(POLICIES).origin).parent  # type: ignore[union-attr, arg-type]
    folders = (package / "recipes", package.parent / "recipes")
    files = {file.stem: file for folder in folders for file in sorted(folder.glob("*.yaml"))}
    if name not in files:
        raise ValueError(f"There is no recipe {name!r}. {suggest(name, files)}")
    return files[name]

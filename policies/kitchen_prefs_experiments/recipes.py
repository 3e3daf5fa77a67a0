"""Finds the training recipes: YAML files.

`lerobot-train --config_path` takes them, `kitchen-prefs reinforce --recipe` those of reinforcement
learning. In a checkout they are beside this package, in `policies/recipes/`; in a wheel, inside it.
"""

from pathlib import Path

from kitchen_prefs.utils.suggestions import suggest


def recipe_file(name: str) -> Path:
    """The YAML file of a recipe.

    Args:
        name: Such as "ttp_quick".

    Raises:
        ValueError: If there is no such recipe; the message suggests the nearest.
    """
    package = Path(__file__).parent
    folders = (package / "recipes", package.parent / "recipes")
    files = {file.stem: file for folder in folders for file in sorted(folder.glob("*.yaml"))}
    if name not in files:
        raise ValueError(f"There is no recipe {name!r}. {suggest(name, files)}")
    return files[name]

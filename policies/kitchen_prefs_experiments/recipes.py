"""Finds the training recipes: YAML files.

`kitchen-prefs train --recipe` and `lerobot-train --config_path` take them, `kitchen-prefs reinforce
--recipe` those of reinforcement learning. In a checkout they are beside this package, in
`policies/recipes/`; in a wheel, inside it.
"""

from pathlib import Path

import yaml

from kitchen_prefs.utils.suggestions import suggest


def recipe_file(name: str) -> Path:
    """The YAML file of a recipe.

    Args:
        name: Such as "ttp_quick".

    Raises:
        ValueError: If there is no such recipe; the message suggests the nearest.
    """
    files = _recipe_files()
    if name not in files:
        raise ValueError(f"There is no recipe {name!r}. {suggest(name, files)}")
    return files[name]


def training_data(name: str) -> str:
    """The data set that a recipe trains on, such as "kitchen_prefs/dishwasher-train-v1".

    Raises:
        ValueError: If there is no such recipe, or if it is one of reinforcement learning.
    """
    settings = _settings(recipe_file(name))
    if "dataset" not in settings:
        raise ValueError(
            f"The recipe {name!r} learns from rewards: `kitchen-prefs reinforce --recipe={name}`."
        )
    return settings["dataset"]["repo_id"]


def training_recipes() -> list[str]:
    """The names of the recipes that train on a data set."""
    return [name for name, file in _recipe_files().items() if "dataset" in _settings(file)]


def _recipe_files() -> dict[str, Path]:
    package = Path(__file__).parent
    folders = (package / "recipes", package.parent / "recipes")
    return {file.stem: file for folder in folders for file in sorted(folder.glob("*.yaml"))}


def _settings(file: Path) -> dict:
    return yaml.safe_load(file.read_text())

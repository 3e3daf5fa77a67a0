"""Where recipes lie: `policies/recipes/` in a checkout, inside this package in a wheel."""

from pathlib import Path

from kitchen_prefs.splits import suggest

HERE = Path(__file__).parent
FOLDERS = (HERE / "recipes", HERE.parent / "recipes")


def recipe_file(name: str) -> Path:
    """The YAML file of a recipe, for `lerobot-train --config_path`.

    Args:
        name: Such as "ttp_quick".

    Raises:
        ValueError: If there is no such recipe; the message suggests the nearest.
    """
    files = {file.stem: file for folder in FOLDERS for file in sorted(folder.glob("*.yaml"))}
    if name not in files:
        raise ValueError(f"There is no recipe {name!r}. {suggest(name, files)}")
    return files[name]

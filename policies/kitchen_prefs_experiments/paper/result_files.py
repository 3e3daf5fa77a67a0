"""The facts of a table, results/TABLE.json: what was run, and what came of it.

table, data_version, package_version   what the facts are of
recipes, budget                        where something was trained: its recipes, and how many
                                       decisions each training from nothing saw
rows                                   by what they are called:
    checkpoint | rule | options        which policy: a committed checkpoint, a rule, or what
                                       lerobot-train was told beside the recipe
    seconds                            how long the training's steps took
    policies                           instead of these two, where a row stands for several
                                       policies: the two of each
    groups                             by split or number of dishes: the number of episodes, and
                                       each metric's mean, low and high end of the 95 % interval
    steps, seconds, best, points       of a learning curve instead: how many steps in how many
                                       seconds, the best checkpoint's step, and each checkpoint's
                                       step, seconds and metrics on val
"""

import json
from importlib.metadata import version
from pathlib import Path

from kitchen_prefs.splits import DATA_VERSION
from kitchen_prefs.utils.files import write_json
from kitchen_prefs_experiments.paper.paper_tables import TABLES


def make_facts(name: str, rows: dict[str, dict], conditions: dict) -> dict:
    """The facts of a table.

    Args:
        name: The table's name.
        rows: What came of it.
        conditions: The recipe and the budget, where something was trained with them.
    """
    return {
        "table": name,
        "data_version": DATA_VERSION,
        "package_version": version("lerobot_policy_kitchen_prefs"),
        **conditions,
        "rows": rows,
    }


def write_facts(facts: dict, folder: Path) -> None:
    """Write the facts of a table to FOLDER/TABLE.json."""
    write_json(folder / f"{facts['table']}.json", facts)


def read_facts(folder: Path) -> dict[str, dict]:
    """The facts of the tables that FOLDER holds, in the order of `TABLES`.

    Raises:
        ValueError: If a file is not JSON.
    """
    files = {name: folder / f"{name}.json" for name in TABLES}
    return {name: _read(file) for name, file in files.items() if file.exists()}


def _read(file: Path) -> dict:
    try:
        return json.loads(file.read_text())
    except ValueError as error:
        way_out = f"`kitchen-prefs reproduce {file.stem}` writes it anew."
        raise ValueError(f"{file} is damaged; {way_out}") from error

"""Checks a data set of the drawers by what it says, not by its videos.

A video's bytes differ by the encoder of the machine that made it, so rows, actions, chosen rows,
preferences and tasks alone make the fingerprint. The rows are measured in rendered pictures: a set
that is made anew with another OpenGL may differ from the published one by rounding.
"""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.datasets.columns import SETS, fingerprint, flat_numbers, read_tasks
from kitchen_prefs_robot.demonstrations.loading import damage_told, read_frames
from kitchen_prefs_robot.demonstrations.storage import COLUMNS

FINGERPRINTS = Path(__file__).with_name("fingerprints.json")
WIDTHS = {SETS: (instances.CAPACITY, instances.COLUMNS), "action": (7,)}


def verify_demonstrations(name: str, root: Path) -> Iterator[str]:
    """Check a data set of the drawers.

    Args:
        name: Its name, such as "drawers-human-v1".
        root: Its folder.

    Yields:
        A sentence for each thing that was checked and holds.

    Raises:
        ValueError: If something does not hold; the message says what.
    """
    with damage_told(root):
        columns, tasks = _read(root)
    sets, chosen = columns[SETS], columns["chosen_index"]
    frames = np.arange(len(chosen))
    if not instances.choosable(sets)[frames, chosen].all():
        raise ValueError(f"{root} is wrong: a chosen row may not be chosen.")
    yield "Each chosen row is one that the decision may choose."
    if (sets[frames, chosen, instances.POSE] != columns["action"]).any():
        raise ValueError(f"{root} is wrong: an action is not the pose of its chosen row.")
    yield "Each action is the pose of its chosen row."
    published = json.loads(FINGERPRINTS.read_text()).get(name)
    found = fingerprint(columns, tasks)
    if published not in (None, found):
        raise ValueError(
            f"{root} differs from the published {name}: its rows are others. Demonstrations made "
            "with another OpenGL than Mesa's differ by rounding; use them under another name."
        )
    yield f"Its fingerprint is {found}{'' if published else ', and none is published yet'}."


def _read(root: Path) -> tuple[dict[str, np.ndarray], list[str]]:
    """The columns that make the fingerprint, in frame order, and the tasks."""
    table = read_frames(root, COLUMNS)
    columns = {
        column: flat_numbers(table[column]).reshape(-1, *WIDTHS.get(column, ()))
        for column in COLUMNS
    }
    return columns, read_tasks(root)

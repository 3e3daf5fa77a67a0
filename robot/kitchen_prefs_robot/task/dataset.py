"""The data set of demonstrations that a policy of the drawers is trained on."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from filelock import FileLock

from kitchen_prefs import instances
from kitchen_prefs.datasets.manifest import read_manifest, write_manifest
from kitchen_prefs.datasets.names import NAMESPACE, dataset_root
from kitchen_prefs.datasets.writing import frames_of, write_episodes
from kitchen_prefs.envs.demonstrations import Demonstration
from kitchen_prefs.utils.files import atomic_folder
from kitchen_prefs_robot.task.decisions import Toggle
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.preferences import LABELS
from kitchen_prefs_robot.task.sessions import DATA_VERSION, DISHES, DrawersSession, make_session
from kitchen_prefs_robot.task.summaries import summarise

NAME = f"drawers-train-v{DATA_VERSION}"
SESSIONS = len(LABELS["train"]) * len(DISHES["train"])  # each preference once with each number

CARD = """---
license: apache-2.0
task_categories: [robotics]
tags: [LeRobot, kitchen_prefs, drawers]
---

# {name}

{episodes} demonstrations, {frames} decisions, of a scripted expert that loads two drawers by
{preferences} preferences: {fewest} to {most} dishes of two to four categories. Made without physics
by `kitchen-prefs robot data`, for training; the partitions of categories that validation and test
have are not in it. Columns as in the data sets of the kitchen (`{namespace}/dishwasher-train-v1`).
"""


def make_dataset() -> Path:
    """Make the data set if it is not there.

    Returns:
        Its folder, where LeRobot finds it as `kitchen_prefs/drawers-train-v1`.

    Raises:
        ValueError: If the one that is there is incomplete or damaged.
        OSError: If it cannot be written.
    """
    root = dataset_root(NAME)
    root.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(root.with_name(f".{NAME}.lock")):
        if not root.exists():
            with atomic_folder(root) as unfinished:
                _write(unfinished)
    read_manifest(NAME, root)
    return root


def _write(root: Path) -> None:
    write_episodes(NAME, map(frames_of, _demonstrations()), SESSIONS, root)
    manifest = write_manifest(NAME, root)
    (root / "README.md").write_text(
        CARD.format(
            **manifest,
            preferences=len(LABELS["train"]),
            fewest=min(DISHES["train"]),
            most=max(DISHES["train"]),
            namespace=NAMESPACE,
        )
    )


def _demonstrations() -> Iterator[Demonstration]:
    return (as_recorded(make_session("train", index)) for index in range(SESSIONS))


def as_recorded(session: DrawersSession) -> Demonstration:
    """The demonstration of a session with all that the columns of a data set hold."""
    shown = demonstrate(session)
    last = np.arange(len(shown.chosen)) == len(shown.chosen) - 1  # (T,)
    chosen_rows = [rows[row] for rows, row in zip(shown.sets, shown.chosen, strict=True)]
    summaries = [summarise(state, decision) for decision, state in enumerate(shown.states)]
    moves_dish = [not isinstance(decision, Toggle) for decision in shown.decisions]
    return Demonstration(
        instances=np.stack([instances.pack(rows) for rows in shown.sets]),
        environment_state=np.stack([summary for summary, _ in summaries]),
        state=np.stack([state for _, state in summaries]),
        action=np.stack(chosen_rows)[:, instances.POSE],
        chosen_index=np.array(shown.chosen, dtype=np.int64),
        reward=np.array(moves_dish, dtype=np.float32),
        done=last,
        success=last,
        preference=session.label,
        task=session.preference.in_words,
    )

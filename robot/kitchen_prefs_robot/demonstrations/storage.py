"""Human demonstrations as a LeRobot data set with the cameras' videos.

A frame is a decision: what the cameras saw before it, the instance set made of that, and the row
that was chosen, in the columns of `kitchen_prefs.datasets.columns`. `meta/demonstrations.json` says
which scene, preference and dishes each episode shows, and which dishes were misread.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from kitchen_prefs import instances
from kitchen_prefs.datasets.columns import FEATURES, FPS, SETS
from kitchen_prefs.utils.files import (
    at_work_alone,
    atomic_folder,
    make_folder,
    require_empty,
    write_json,
)
from kitchen_prefs_robot.demonstrations.loading import MADE_OF
from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.demonstrations.recording import HumanDemonstration
from kitchen_prefs_robot.scene.views import PICTURE_SIZE

NAME = "drawers-human-v1"
REPO_ID = f"kitchen_prefs/{NAME}"
ROBOT_TYPE = "franka_panda"
CARD = Path(__file__).with_name("card.md")
COLUMNS = (SETS, "action", "chosen_index", "preference", "next.done")


def write_demonstrations(demonstrations: Iterable[HumanDemonstration], root: Path) -> None:
    """Write a data set, one episode a demonstration.

    Args:
        demonstrations: Recorded while they are written.
        root: The data set's folder, which is made; nothing is left of it if a recording fails.

    Raises:
        ValueError: If the folder holds something already, or a demonstration is none.
        OSError: If the folder cannot be written.
    """
    require_empty(root, "--out")
    make_folder(root.parent, "--out")
    with at_work_alone(root), atomic_folder(root) as unfinished:
        unfinished.rmdir()  # LeRobot makes it
        made_of = _write(demonstrations, unfinished)
        write_json(unfinished / MADE_OF, {"episodes": made_of})
        (unfinished / "README.md").write_text(CARD.read_text())


def _write(demonstrations: Iterable[HumanDemonstration], root: Path) -> list[dict[str, Any]]:
    from lerobot.datasets import LeRobotDataset  # here, because it takes seconds to import

    made_of: list[dict[str, Any]] = []
    dataset = None
    for shown in demonstrations:
        if dataset is None:
            features = {name: FEATURES[name] for name in COLUMNS} | _videos(shown)
            dataset = LeRobotDataset.create(
                REPO_ID, FPS, features, root, ROBOT_TYPE, video_backend="pyav"
            )
        for frame in _frames(shown):
            dataset.add_frame(frame)
        dataset.save_episode()
        dishes = sorted(human_preference(shown.preference).categories)
        made_of.append(
            {
                "scene": shown.scene,
                "preference": shown.preference,
                "dishes": dishes,
                "misread": shown.misread,
            }
        )
    if dataset is not None:
        dataset.finalize()
    return made_of


def _videos(shown: HumanDemonstration) -> dict[str, dict[str, Any]]:
    width, height = PICTURE_SIZE
    names = ["height", "width", "channels"]
    feature = {"dtype": "video", "shape": (height, width, 3), "names": names}
    return {f"observation.images.{camera}": feature for camera in shown.pictures}


def _frames(shown: HumanDemonstration) -> Iterable[dict[str, Any]]:
    """The episode as LeRobot records it, decision by decision."""
    task = human_preference(shown.preference).in_words
    last = len(shown.chosen) - 1
    for step, (rows, chosen) in enumerate(zip(shown.sets, shown.chosen, strict=True)):
        pictures = {f"observation.images.{c}": shown.pictures[c][step] for c in shown.pictures}
        yield pictures | {
            SETS: instances.pack(rows).ravel(),
            "action": rows[chosen, instances.POSE],
            "chosen_index": np.array([chosen], dtype=np.int64),
            "preference": np.array([shown.preference], dtype=np.int64),
            "next.done": np.array([step == last]),
            "task": task,
        }

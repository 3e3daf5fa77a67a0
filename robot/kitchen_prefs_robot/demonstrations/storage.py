"""Human demonstrations as a LeRobot data set with the cameras' videos, and as prompts.

A frame is a decision: what the cameras saw before it, the instance set made of that, and the row
that was chosen, in the columns of `kitchen_prefs.datasets.columns`. `meta/demonstrations.json` says
which scene and which dishes each episode shows.
"""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from kitchen_prefs import instances
from kitchen_prefs.datasets.columns import FEATURES, FPS, SETS, flat_numbers
from kitchen_prefs.utils.files import (
    at_work_alone,
    atomic_folder,
    make_folder,
    require_empty,
    write_json,
)
from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.demonstrations.recording import HumanDemonstration
from kitchen_prefs_robot.scene.views import PICTURE_SIZE
from kitchen_prefs_robot.task.rows import prompt_of

NAME = "drawers-human-v1"
REPO_ID = f"kitchen_prefs/{NAME}"
ROBOT_TYPE = "franka_panda"
MADE_OF = Path("meta") / "demonstrations.json"
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


def read_prompt(root: Path, episode: int = 0) -> np.ndarray:
    """An episode of a data set as a prompt.

    Args:
        root: The data set's folder.
        episode: Its number.

    Returns:
        The sets of all its decisions, the chosen rows marked, (1664, 14) float32.

    Raises:
        ValueError: If there is no such data set or episode.
    """
    paths = sorted(root.glob("data/*/*.parquet"))
    if not paths:
        raise ValueError(f"There is no data set of demonstrations in {root}; give its folder.")
    wanted = [SETS, "chosen_index", "episode_index"]
    try:
        table = pa.concat_tables([pq.read_table(path, columns=wanted) for path in paths])
    except (pa.ArrowInvalid, KeyError) as error:
        raise ValueError(
            f"{root} is damaged or no data set of kitchen_prefs; make it again with "
            "`kitchen-prefs robot demonstrate`."
        ) from error
    numbers = flat_numbers(table["episode_index"])
    chosen = flat_numbers(table["chosen_index"])[numbers == episode]
    if len(chosen) == 0:
        last = numbers.max(initial=-1)
        raise ValueError(f"There is no episode {episode} in {root}; the last is {last}.")
    sets = flat_numbers(table[SETS]).reshape(len(numbers), -1)[numbers == episode]  # (T, 936)
    return prompt_of([instances.unpad(one) for one in sets], chosen.tolist())


def require_same_dishes(root: Path, episode: int, categories: Iterable[str]) -> None:
    """Make sure that a demonstration shows the dishes of a scene.

    Args:
        root: The data set's folder.
        episode: The demonstration's number.
        categories: Of the scene's dishes.

    Raises:
        ValueError: If it does not, or if there is no such demonstration.
    """
    file = root / MADE_OF
    if not file.is_file():
        raise ValueError(f"There is no data set of demonstrations in {root}; give its folder.")
    episodes = json.loads(file.read_text())["episodes"]
    if not 0 <= episode < len(episodes):
        raise ValueError(
            f"There is no episode {episode} in {root}; the last is {len(episodes) - 1}."
        )
    shown, there = set(episodes[episode]["dishes"]), set(categories)
    if shown != there:
        raise ValueError(
            f"The demonstration shows {', '.join(sorted(shown))}, but the scene has "
            f"{', '.join(sorted(there))}; give a demonstration of the same dishes."
        )


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
        made_of.append({"scene": shown.scene, "preference": shown.preference, "dishes": dishes})
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

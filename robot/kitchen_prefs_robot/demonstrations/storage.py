"""Human demonstrations as a LeRobot data set with the cameras' videos, and as prompts.

A frame is a decision: what the cameras saw before it, the instance set made of that, and the row
that was chosen, in the columns of `kitchen_prefs.datasets.columns`. `meta/demonstrations.json` says
which scene, preference and dishes each episode shows, and which dishes were misread.
"""

import json
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
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


@dataclass(frozen=True)
class Origin:
    """What an episode of a data set shows.

    Attributes:
        scene: The seed of the scene.
        preference: The number of the preference.
        misread: As `HumanDemonstration.misread`.
    """

    scene: int
    preference: int
    misread: tuple[tuple[str, str], ...]


class NoDataSetError(ValueError):
    """There is no data set in a folder."""

    def __init__(self, root: Path) -> None:
        super().__init__(f"There is no data set of demonstrations in {root}; give its folder.")


@contextmanager
def damage_told(root: Path) -> Iterator[None]:
    """Say of a data set that cannot be read that it is damaged, or another one.

    Raises:
        ValueError: If what is done with it fails.
    """
    try:
        yield
    except NoDataSetError:
        raise
    except (pa.ArrowException, ValueError, KeyError, TypeError, AttributeError, OSError) as error:
        raise ValueError(
            f"{root} is damaged or no data set of these demonstrations; make it again with "
            "`kitchen-prefs robot demonstrate`."
        ) from error


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
    with damage_told(root):
        table = read_frames(root, (SETS, "chosen_index", "episode_index"))
    numbers = flat_numbers(table["episode_index"])
    chosen = flat_numbers(table["chosen_index"])[numbers == episode]
    if len(chosen) == 0:
        last = numbers.max(initial=-1)
        raise ValueError(f"There is no episode {episode} in {root}; the last is {last}.")
    sets = flat_numbers(table[SETS]).reshape(len(numbers), -1)[numbers == episode]  # (T, 936)
    return prompt_of([instances.unpad(one) for one in sets], chosen.tolist())


def read_origin(root: Path, episode: int = 0) -> Origin:
    """What an episode of a data set shows.

    Args:
        root: The data set's folder.
        episode: Its number.

    Raises:
        ValueError: If there is no such data set or episode.
    """
    file = root / MADE_OF
    if not file.is_file():
        raise NoDataSetError(root)
    with damage_told(root):
        episodes = json.loads(file.read_text())["episodes"]
        origins = [
            Origin(int(one["scene"]), int(one["preference"]), _pairs(one.get("misread", [])))
            for one in episodes
        ]
    if episode >= len(origins):
        raise ValueError(
            f"There is no episode {episode} in {root}; the last is {len(origins) - 1}."
        )
    return origins[episode]


def read_frames(root: Path, columns: Sequence[str]) -> pa.Table:
    """Some columns of a data set, in frame order.

    Raises:
        ValueError: If there is no data set.
    """
    paths = sorted(root.glob("data/*/*.parquet"))
    if not paths:
        raise NoDataSetError(root)
    return pa.concat_tables([pq.read_table(path, columns=list(columns)) for path in paths])


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


def _pairs(misread: Iterable[Sequence[str]]) -> tuple[tuple[str, str], ...]:
    """Pairs of categories as JSON has them."""
    return tuple((str(own), str(seen)) for own, seen in misread)


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

"""Copy a data set with a drawing of each decision, for `lerobot-dataset-viz`.

The drawing shows what the demonstration decides, so it is no observation: its name does not begin
with "observation", and so LeRobot hands it to no policy.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from datasets import disable_progress_bars, enable_progress_bars
from filelock import FileLock
from lerobot.datasets import LeRobotDataset
from tqdm import tqdm

from kitchen_prefs.datasets.columns import FEATURES, FPS, ROBOT_TYPE, read_columns, read_tasks
from kitchen_prefs.datasets.loading import make_dataset
from kitchen_prefs.datasets.names import Content, content_of, dataset_root
from kitchen_prefs.rendering.plan import draw_plan
from kitchen_prefs.rendering.plan_ground import HEIGHT, WIDTH
from kitchen_prefs.simulation.kitchen import Kitchen
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs.utils.files import atomic_folder

DRAWING = "drawing"
DRAWN_FEATURES = {
    **FEATURES,
    DRAWING: {
        "dtype": "image",
        "shape": (HEIGHT, WIDTH, 3),
        "names": ["height", "width", "channels"],
    },
}


def draw_dataset(name: str, episodes: Sequence[int] | None = None) -> Path:
    """Copy a data set, which is made first if it is not there, with a drawing in each frame.

    Args:
        name: The data set's name; the copy's is NAME-drawn.
        episodes: Which episodes, numbered anew in the copy; None takes all.

    Returns:
        The copy's folder.

    Raises:
        ValueError: If there is no such data set or episode, or the copy is there already.
        OSError: If it cannot be written; nothing is left behind.
    """
    content = content_of(name)
    if content.is_of_people:
        raise ValueError(
            f"{content.name} is of the second tier, of which there are no drawings; draw a data "
            "set of the first, such as dishwasher-val-v1."
        )
    count = len(content.sessions)
    chosen = range(count) if episodes is None else episodes
    wrong = [number for number in chosen if not 0 <= number < count]
    if wrong:
        raise ValueError(
            f"{content.name} has no episode {wrong[0]}; its episodes are 0 to {count - 1}."
        )
    source, copy = make_dataset(content.name), dataset_root(f"{content.name}-drawn")
    with FileLock(copy.with_name(f".{copy.name}.lock")):
        if copy.exists():
            raise ValueError(f"{copy} is there already; delete the folder to draw it again.")
        with atomic_folder(copy) as unfinished:
            unfinished.rmdir()  # LeRobot makes it itself
            _write(content, source, unfinished, chosen)
    return copy


def _write(content: Content, source: Path, root: Path, episodes: Sequence[int]) -> None:
    columns, tasks = read_columns(source), read_tasks(source)
    copy = LeRobotDataset.create(
        f"{content.repo_id}-drawn",
        FPS,
        DRAWN_FEATURES,
        root,
        ROBOT_TYPE,
        use_videos=False,
        video_backend="pyav",  # there are none; LeRobot would look for a decoder and log about it
    )
    disable_progress_bars()  # LeRobot's, one for each episode
    try:
        for episode in tqdm(episodes, f"{content.name}-drawn", unit="episode"):
            frames = np.flatnonzero(columns["episode_index"] == episode)
            pictures = _pictures(*content.sessions[episode])
            for frame, picture in zip(frames, pictures, strict=True):
                values = {name: _value(name, columns[name][frame]) for name in FEATURES}
                task = tasks[columns["task_index"][frame]]
                copy.add_frame({**values, DRAWING: picture, "task": task})
            copy.save_episode()
    finally:
        copy.finalize()  # else LeRobot writes on after the folder of a failed copy is deleted
        enable_progress_bars()


def _value(name: str, value: np.ndarray) -> np.ndarray:
    """A value of a column in the shape that LeRobot wants."""
    return np.reshape(value, FEATURES[name]["shape"])


def _pictures(split: str, index: int) -> Iterator[np.ndarray]:
    """A drawing of each decision of the demonstration of a session, (H, W, 3) uint8 each."""
    session = make_session(split, index)
    kitchen, decisions = Kitchen(session.dishes), expert_trajectory(session).decisions
    for number, instance in enumerate(decisions):
        yield draw_plan(kitchen, session.preference, instance, number, len(decisions))
        kitchen.decide(instance)

"""Write a data set in LeRobot's format 3.0, on all cores.

Processes demonstrate the sessions and compute the statistics of each episode; this process writes.
The files are those that `LeRobotDataset.add_frame` and `save_episode` would write, which take
several times as long: they convert value by value and rewrite the statistics after each episode.
"""

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
from lerobot.datasets import CODEBASE_VERSION, aggregate_stats
from lerobot.datasets.compute_stats import compute_episode_stats
from lerobot.datasets.feature_utils import create_empty_dataset_info, get_hf_features_from_features
from lerobot.datasets.io_utils import write_info, write_stats, write_tasks
from lerobot.datasets.utils import DEFAULT_DATA_PATH, DEFAULT_EPISODES_PATH
from lerobot.utils.constants import DEFAULT_FEATURES
from lerobot.utils.utils import flatten_dict
from tqdm import tqdm

from kitchen_prefs.datasets.cards import card, card_facts
from kitchen_prefs.datasets.certificates import certificate_of, write_certificates
from kitchen_prefs.datasets.columns import (
    FEATURES,
    FPS,
    PEOPLE_FEATURES,
    ROBOT_TYPE,
    columns_of,
    features_of,
    with_statistics,
)
from kitchen_prefs.datasets.manifest import write_manifest
from kitchen_prefs.datasets.names import Content
from kitchen_prefs.envs.demonstrations import Demonstration, demonstrate
from kitchen_prefs.envs.people_demonstrations import demonstrate_people
from kitchen_prefs.people.certificates import Certificate
from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.people.splits import PEOPLE_SPLITS
from kitchen_prefs.simulation.sessions import make_session

# One file. LeRobot would begin another at 100 MB, which people_train alone passes; it reads any.
FIRST_FILE = {"chunk_index": 0, "file_index": 0}
EPISODES_A_TASK = 4  # enough to make passing them between processes cheap, few enough to share out

Stats = dict[str, dict[str, np.ndarray]]


@dataclass(frozen=True)
class EpisodeFrames:
    """The frames of one demonstrated episode.

    Attributes:
        columns: As from `columns_of`.
        task: The preference, or the user, in words.
        stats: LeRobot's statistics of the columns.
        certificate: How sure the exact reader is of it; None in the first tier.
    """

    columns: dict[str, np.ndarray]
    task: str
    stats: Stats
    certificate: Certificate | None = None


def write_dataset(content: Content, root: Path, workers: int | None = None) -> None:
    """Write a data set; the files do not depend on the number of workers.

    Args:
        content: Which sessions to demonstrate.
        root: Its folder, which is empty or does not exist yet.
        workers: How many processes; None takes all cores.

    Raises:
        OSError: If the files cannot be written.
    """
    with _demonstrated(content, workers) as episodes:
        write_episodes(content.name, episodes, len(content.sessions), root)
    manifest = write_manifest(content.name, root)
    (root / "README.md").write_text(card(content, card_facts(manifest, root)))


def write_episodes(name: str, episodes: Iterable[EpisodeFrames], count: int, root: Path) -> None:
    """Write the data and the metadata of a data set, without manifest and card.

    Args:
        name: The data set's name, which the progress bar shows.
        episodes: Its episodes in order.
        count: How many there are.
        root: Its folder, which is empty or does not exist yet.

    Raises:
        OSError: If the files cannot be written.
    """
    data = root / DEFAULT_DATA_PATH.format(**FIRST_FILE)
    data.parent.mkdir(parents=True)
    features = features_of(name) | DEFAULT_FEATURES
    schema = get_hf_features_from_features(features).arrow_schema
    tasks: dict[str, int] = {}
    stats: list[Stats] = []
    rows: list[dict] = []
    certificates: list[Certificate] = []
    with pq.ParquetWriter(data, schema, compression="snappy") as file:
        for episode in tqdm(episodes, name, count, unit="episode"):
            start = rows[-1]["dataset_to_index"] if rows else 0
            task_index = tasks.setdefault(episode.task, len(tasks))
            bookkeeping = _bookkeeping(len(rows), start, len(episode.columns["action"]), task_index)
            stats.append(episode.stats | compute_episode_stats(bookkeeping, features))
            rows.append(_episode_row(bookkeeping, episode.task, stats[-1]))
            table = _table(episode.columns | bookkeeping, schema)
            file.write_table(table)  # one row group an episode, as LeRobot has it
            if episode.certificate is not None:
                certificates.append(episode.certificate)
    _write_meta(root, features, tasks, stats, rows)
    if certificates:
        write_certificates(certificates, root)


def frames_of(
    demonstration: Demonstration, features: dict[str, dict[str, Any]] = FEATURES
) -> EpisodeFrames:
    """The frames of a demonstration with their statistics."""
    columns = columns_of(demonstration)
    stats = compute_episode_stats(with_statistics(columns), features)
    return EpisodeFrames(columns, demonstration.task, stats)


@contextmanager
def _demonstrated(content: Content, workers: int | None) -> Iterator[Iterator[EpisodeFrames]]:
    """The episodes of a data set in order, demonstrated by other processes."""
    # Forked processes start at once and need no `if __name__ == "__main__"` in the user's script.
    # They may be forked from a process with torch's threads, as they compute with numpy alone.
    context = multiprocessing.get_context("fork" if sys.platform == "linux" else "spawn")
    with ProcessPoolExecutor(workers, context, initializer=_leave_with_parent) as pool:
        try:
            yield pool.map(_demonstrate, content.sessions, chunksize=EPISODES_A_TASK)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _leave_with_parent() -> None:
    """Let a worker end with its parent; one that outlived it would keep the data set's lock."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to handle
    parent = multiprocessing.parent_process()
    assert parent is not None

    def leave() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=leave, daemon=True).start()


def _demonstrate(session: tuple[str, int]) -> EpisodeFrames:
    split, index = session
    if split not in PEOPLE_SPLITS:
        return frames_of(demonstrate(make_session(split, index)))
    of_people = make_people_session(split, index)
    return replace(
        frames_of(demonstrate_people(of_people), PEOPLE_FEATURES),
        certificate=certificate_of(of_people),
    )


def _bookkeeping(number: int, start: int, frames: int, task_index: int) -> dict[str, np.ndarray]:
    """The columns that LeRobot adds to an episode."""
    return {
        "timestamp": np.arange(frames, dtype=np.float32) / FPS,
        "frame_index": np.arange(frames),
        "episode_index": np.full(frames, number),
        "index": np.arange(start, start + frames),
        "task_index": np.full(frames, task_index),
    }


def _episode_row(bookkeeping: dict[str, np.ndarray], task: str, stats: Stats) -> dict:
    """An episode's row in meta/episodes."""
    index = bookkeeping["index"]
    flat_stats = {key: value.tolist() for key, value in flatten_dict({"stats": stats}).items()}
    return {
        "episode_index": int(bookkeeping["episode_index"][0]),
        "tasks": [task],
        "length": len(index),
        **{f"data/{key}": value for key, value in FIRST_FILE.items()},
        "dataset_from_index": int(index[0]),
        "dataset_to_index": int(index[-1]) + 1,
        **flat_stats,
        **{f"meta/episodes/{key}": value for key, value in FIRST_FILE.items()},
    }


def _table(columns: dict[str, np.ndarray], schema: pa.Schema) -> pa.Table:
    return pa.Table.from_arrays([_array(columns[f.name], f.type) for f in schema], schema=schema)


def _array(values: np.ndarray, kind: pa.DataType) -> pa.Array:
    flat = pa.array(values.ravel())
    return flat if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, type=kind)


def _write_meta(
    root: Path, features: dict, tasks: dict[str, int], stats: list[Stats], rows: list[dict]
) -> None:
    info = create_empty_dataset_info(
        CODEBASE_VERSION, FPS, features, use_videos=False, robot_type=ROBOT_TYPE
    )
    info.total_episodes = len(rows)
    info.total_frames = rows[-1]["dataset_to_index"]
    info.total_tasks = len(tasks)
    info.splits = {"train": f"0:{len(rows)}"}  # LeRobot's word for all episodes of a data set
    write_info(info, root)
    write_stats(aggregate_stats(stats), root)
    index = pd.Index(list(tasks), name="task")
    write_tasks(pd.DataFrame({"task_index": list(tasks.values())}, index=index), root)
    episodes = root / DEFAULT_EPISODES_PATH.format(**FIRST_FILE)
    episodes.parent.mkdir(parents=True)
    pq.write_table(pa.Table.from_pylist(rows), episodes)

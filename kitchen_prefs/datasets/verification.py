"""Verifies a data set against its files: every property that it must have."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from lerobot.datasets import aggregate_stats
from lerobot.datasets.compute_stats import compute_episode_stats
from lerobot.utils.constants import DEFAULT_FEATURES
from tqdm import tqdm

from kitchen_prefs import instances
from kitchen_prefs.datasets.columns import (
    FEATURES,
    FPS,
    fingerprint,
    read_columns,
    read_tasks,
    with_statistics,
)
from kitchen_prefs.datasets.manifest import published_fingerprint, read_manifest
from kitchen_prefs.datasets.names import Content, content_of, dataset_root
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.metrics import edit_similarity, packing_efficiency
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import SPLITS

REPLAYED = 20  # episodes spread over the data set; a wrong kitchen or expert shows in any of them
STATS_TOLERANCE = 1e-3  # LeRobot adds float32 means of squares, so its deviations are that inexact
EPISODE_FACTS = ("length", "dataset_from_index", "dataset_to_index")


@dataclass(frozen=True)
class Data:
    """A data set as its files hold it.

    Attributes:
        content: What it should hold.
        manifest: What it says about itself.
        columns: As from `read_columns`.
        tasks: As from `read_tasks`.
        stats: LeRobot's statistics.
        lengths: The number of frames of each episode, (E,).
        starts: Its first frame, as LeRobot looks it up, (E,).
        ends: The frame after its last, (E,).
    """

    content: Content
    manifest: dict
    columns: dict[str, np.ndarray]
    tasks: list[str]
    stats: dict[str, dict]
    lengths: np.ndarray
    starts: np.ndarray
    ends: np.ndarray

    def frames(self, episode: int) -> slice:
        """The frames of an episode."""
        start = int(self.lengths[:episode].sum())
        return slice(start, start + int(self.lengths[episode]))


def verify_dataset(name: str) -> Iterator[str]:
    """Check a data set.

    Args:
        name: The data set's name; it is not made if it is not there.

    Yields:
        A sentence for each thing that was checked and holds.

    Raises:
        ValueError: If something does not hold; the message says what.
    """
    data = _read(name)
    yield "Its files are as they were written."
    for claim, check in CHECKS.items():
        try:
            check(data)
        except ValueError as error:
            raise ValueError(f"The data set {data.content.name} is wrong: {error}") from error
        yield claim


def _read(name: str) -> Data:
    content = content_of(name)
    root = dataset_root(content.name)
    if not root.exists():
        raise ValueError(
            f"The data set {content.name} is not in {root.parent}; "
            f"`kitchen-prefs datasets make {content.name}` makes it."
        )
    manifest = read_manifest(content.name, root)
    return Data(
        content,
        manifest,
        read_columns(root),
        read_tasks(root),
        json.loads((root / "meta" / "stats.json").read_text()),
        *_episode_facts(root),
    )


def _episode_facts(root: Path) -> list[np.ndarray]:
    paths = sorted((root / "meta" / "episodes").glob("*/*.parquet"))
    table = pa.concat_tables([pq.read_table(path, columns=list(EPISODE_FACTS)) for path in paths])
    return [table[name].to_numpy() for name in EPISODE_FACTS]


def _check_fingerprint(data: Data) -> None:
    found = fingerprint(data.columns, data.tasks)
    if found != data.manifest["fingerprint"]:
        raise ValueError("its fingerprint is not the one that its metadata records.")
    if published_fingerprint(data.content.name) not in (None, found):
        raise ValueError("it differs from the published data set of this name and version.")


def _check_indices(data: Data) -> None:
    columns, lengths = data.columns, data.lengths
    expected = {
        "index": np.arange(lengths.sum()),
        "episode_index": np.repeat(np.arange(len(lengths)), lengths),
        "frame_index": np.concatenate([np.arange(length) for length in lengths]),
    }
    ends = np.cumsum(lengths)
    if len(lengths) != len(data.content.sessions):
        raise ValueError(f"{len(lengths)} episodes, not {len(data.content.sessions)}.")
    for name, values in expected.items():
        if not np.array_equal(columns[name], values):
            raise ValueError(f"the column {name} does not count up as it must.")
    if not np.array_equal(columns["timestamp"], expected["frame_index"] / FPS):
        raise ValueError("a timestamp is not its frame's.")
    if not (np.array_equal(data.starts, ends - lengths) and np.array_equal(data.ends, ends)):
        raise ValueError("LeRobot's first or last frame of an episode is not the episode's.")
    if not np.isin(columns["task_index"], np.arange(len(data.tasks))).all():
        raise ValueError("a task index has no task.")


def _check_rows(data: Data) -> None:
    for name, values in data.columns.items():
        if not np.isfinite(values).all():
            raise ValueError(f"the column {name} holds NaN or infinity.")
    sets = data.columns["observation.instances"]  # (F, N, 13)
    chosen = data.columns["chosen_index"]  # (F,)
    if chosen.min() < 0 or chosen.max() >= instances.CAPACITY:
        raise ValueError("a chosen index lies outside the instance set.")
    if not instances.choosable(sets)[np.arange(len(chosen)), chosen].all():
        raise ValueError("a chosen index points to a row that the decision may not choose.")


def _check_ends(data: Data) -> None:
    last = np.zeros(len(data.columns["index"]), dtype=bool)  # (F,)
    last[np.cumsum(data.lengths) - 1] = True
    for name in ("next.done", "next.success"):
        if not np.array_equal(data.columns[name], last):
            raise ValueError(f"the column {name} is not true at just the last frames.")


def _check_statistics(data: Data) -> None:
    features = {**FEATURES, **DEFAULT_FEATURES}
    of_episodes = []
    for episode in tqdm(range(len(data.lengths)), "statistics", unit="episode", leave=False):
        frames = data.frames(episode)
        columns = {name: values[frames] for name, values in with_statistics(data.columns).items()}
        of_episodes.append(compute_episode_stats(columns, features))
    for name, computed in aggregate_stats(of_episodes).items():
        for kind, found in computed.items():
            recorded = np.array(data.stats[name][kind])
            if recorded.shape != found.shape or not np.allclose(
                recorded, found, STATS_TOLERANCE, STATS_TOLERANCE
            ):
                raise ValueError(f"the recorded {kind} of the column {name} is not its {kind}.")


def _check_actions(data: Data) -> None:
    sets, chosen = data.columns["observation.instances"], data.columns["chosen_index"]
    poses = sets[np.arange(len(chosen)), chosen, instances.POSE]  # (F, 7)
    wrong = np.flatnonzero((poses != data.columns["action"]).any(1))
    if len(wrong):
        raise ValueError(f"the action of frame {wrong[0]} is not the pose of its chosen row.")


def _check_labels(data: Data) -> None:
    for episode, (split, index) in enumerate(data.content.sessions):
        session = make_session(split, index)
        frames = data.frames(episode)
        if (data.columns["preference"][frames] != session.label).any():
            raise ValueError(f"episode {episode} does not have the preference of its session.")
        tasks = {data.tasks[i] for i in data.columns["task_index"][frames]}
        if tasks != {session.preference.in_words}:
            raise ValueError(f"the task of episode {episode} is not its preference in words.")


def _check_replay(data: Data) -> None:
    quiet = [i for i, (split, _) in enumerate(data.content.sessions) if not SPLITS[split].noisy]
    sample = quiet[:: max(len(quiet) // REPLAYED, 1)]
    for episode in tqdm(sample, "replay", unit="episode", leave=False):
        split, index = data.content.sessions[episode]
        environment = DishwasherLoading(split)
        environment.reset(options={"session": index})
        frames = data.frames(episode)
        rewards = [environment.step(action)[1] for action in data.columns["action"][frames]]
        if not np.array_equal(rewards, data.columns["next.reward"][frames]):
            raise ValueError(f"the rewards of episode {episode} are not those of its decisions.")
        facts = environment.episode()
        if packing_efficiency(facts) != 1 or edit_similarity(facts) != 1 or not facts.finished:
            raise ValueError(f"episode {episode} does not load the dishwasher as the expert does.")


CHECKS: dict[str, Callable[[Data], None]] = {
    "Its fingerprint is the recorded one.": _check_fingerprint,
    "Episodes, frames and tasks are numbered without gaps.": _check_indices,
    "All values are finite, and each chosen row may be chosen.": _check_rows,
    "Just the last decision of each episode is done and successful.": _check_ends,
    "Each action is the pose of the chosen row.": _check_actions,
    "Each episode has the preference of its session, in label and words.": _check_labels,
    "LeRobot's statistics are those of the columns.": _check_statistics,
    "Replayed in a kitchen without noise, demonstrations reach PE 1 and ED 1.": _check_replay,
}

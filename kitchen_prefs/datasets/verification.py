"""Verifies a data set against its files: every property that it must have."""

from collections.abc import Callable, Iterator

import numpy as np
from lerobot.datasets import aggregate_stats
from lerobot.datasets.compute_stats import compute_episode_stats
from lerobot.utils.constants import DEFAULT_FEATURES
from tqdm import tqdm

from kitchen_prefs import instances
from kitchen_prefs.datasets import episode_checks
from kitchen_prefs.datasets.columns import FPS, SETS, features_of, fingerprint, with_statistics
from kitchen_prefs.datasets.manifest import published_fingerprint
from kitchen_prefs.datasets.stored_data import Data, read_data

STATS_TOLERANCE = 1e-3  # LeRobot adds float32 means of squares, so its deviations are that inexact


def verify_dataset(name: str) -> Iterator[str]:
    """Check a data set.

    Args:
        name: The data set's name; it is not made if it is not there.

    Yields:
        A sentence for each thing that was checked and holds.

    Raises:
        ValueError: If something does not hold; the message says what.
    """
    data = read_data(name)
    yield "Its files are as they were written."
    checks = CHECKS | (OF_PEOPLE if data.content.is_of_people else OF_PREFERENCES)
    for claim, check in checks.items():
        try:
            check(data)
        except ValueError as error:
            raise ValueError(f"The data set {data.content.name} is wrong: {error}") from error
        yield claim


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
    sets = data.columns[SETS]  # (F, N, D)
    chosen = data.columns["chosen_index"]  # (F,)
    if chosen.min() < 0 or chosen.max() >= sets.shape[1]:
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
    features = features_of(data.content.name) | DEFAULT_FEATURES
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
    sets, chosen = data.columns[SETS], data.columns["chosen_index"]
    poses = sets[np.arange(len(chosen)), chosen, instances.POSE]  # (F, 7)
    wrong = np.flatnonzero((poses != data.columns["action"]).any(1))
    if len(wrong):
        raise ValueError(f"the action of frame {wrong[0]} is not the pose of its chosen row.")


Check = Callable[[Data], None]
CHECKS: dict[str, Check] = {
    "Its fingerprint is the recorded one.": _check_fingerprint,
    "Episodes, frames and tasks are numbered without gaps.": _check_indices,
    "All values are finite, and each chosen row may be chosen.": _check_rows,
    "Just the last decision of each episode is done and successful.": _check_ends,
    "Each action is the pose of the chosen row.": _check_actions,
    "LeRobot's statistics are those of the columns.": _check_statistics,
}
OF_PREFERENCES: dict[str, Check] = {
    "Each episode has the preference of its session, in label and words.": (
        episode_checks.check_preferences
    ),
    "Replayed in a kitchen without noise, demonstrations reach PE 1 and ED 1.": (
        episode_checks.replay_preferences
    ),
}
OF_PEOPLE: dict[str, Check] = {
    "Each episode has the user of its session, in number and words.": episode_checks.check_users,
    "A sample of the certificates is what the exact reader says.": (
        episode_checks.check_certificates
    ),
    "Replayed, demonstrations reach Where 1 and Turn 1, and nothing is refused.": (
        episode_checks.replay_users
    ),
}

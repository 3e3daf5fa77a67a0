"""Reads what `lerobot-eval --eval.recording=true` recorded as the episodes of a submission.

DIR/
    seen/                       --env.task=seen --output_dir=DIR/seen
        recordings/             a LeRobot data set for each environment
    unseen_preferences/
    ...                         one folder for each test split

A recording does not name its session; the first instance set does, because no two sessions of a
split begin alike.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from tqdm import tqdm

from kitchen_prefs.datasets.columns import flat_numbers
from kitchen_prefs.evaluation.tiers import AnyEpisode, tier_of

COLUMNS = ["instances", "action", "episode_index"]
ADVICE = "run lerobot-eval on the whole split, as docs/lerobot_tools.md shows."


def read_recordings(folder: Path, splits: Sequence[str]) -> dict[str, list[AnyEpisode]]:
    """Read the recordings of test splits and replay their actions.

    Args:
        folder: The folder with an output folder of `lerobot-eval` for each of the splits.
        splits: The splits.

    Returns:
        The episodes of each split, in the order of the sessions.

    Raises:
        ValueError: If a split, a session or the end of an episode is missing, or a recording is
            damaged or belongs to no session.
    """
    for split in splits:
        if not (folder / split / "recordings").is_dir():
            raise ValueError(f"{folder / split} has no recordings; {ADVICE}")
    return {split: _episodes(split, folder / split / "recordings") for split in splits}


def _episodes(split: str, recordings: Path) -> list[AnyEpisode]:
    session_of = _sessions_by_first_set(split)
    found: dict[int, AnyEpisode] = {}
    for first, actions in _recorded(recordings):
        session = session_of.get(_key(first))
        if session is None:
            raise ValueError(f"{recordings} holds an episode of no session of {split}.")
        if session not in found:
            found[session] = _replayed(split, session, actions)
    missing = sorted(set(range(tier_of(split).sessions(split))) - found.keys())
    if missing:
        raise ValueError(f"{recordings} lacks session {missing[0]} of {split}; {ADVICE}")
    return [found[session] for session in sorted(found)]


def _sessions_by_first_set(split: str) -> dict[bytes, int]:
    tier = tier_of(split)
    sessions = tqdm(range(tier.sessions(split)), f"Sessions of {split}", leave=False)
    starts = (tier.make_simulator(split, i).observation.rows for i in sessions)
    return {_key(rows): i for i, rows in enumerate(starts)}


def _key(first: np.ndarray) -> bytes:
    """What tells an episode's first instance set from others, padded or not."""
    return np.trim_zeros(first.ravel(), "b").tobytes()


def _recorded(recordings: Path) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """The first instance set, (N * D,), and the actions, (T, 7), of each recorded episode."""
    for file in sorted(recordings.rglob("data/*/*.parquet")):
        try:
            table = pq.read_table(file, columns=COLUMNS)
            episodes = table["episode_index"].to_numpy()
            sets = flat_numbers(table["instances"]).reshape(len(episodes), -1)
            actions = flat_numbers(table["action"]).reshape(len(episodes), -1)
        except (OSError, ValueError, KeyError, pa.ArrowException) as error:
            raise ValueError(f"{file} is no recording of this environment; {ADVICE}") from error
        for episode in np.unique(episodes):
            frames = episodes == episode
            yield sets[frames][0], actions[frames]


def _replayed(split: str, session: int, actions: np.ndarray) -> AnyEpisode:
    simulator = tier_of(split).make_simulator(split, session)
    for action in actions:
        if simulator.terminated or simulator.truncated:
            raise ValueError(
                f"The recording of session {session} of {split} goes on after its end."
            )
        simulator.act(action)
    if not (simulator.terminated or simulator.truncated):
        raise ValueError(f"The recording of session {session} of {split} ends too early; {ADVICE}")
    return simulator.episode()

"""The columns of a data set: one row a frame, one frame a decision.

    frame 0  observation.instances (936)  action (7)  chosen_index  ...   episode_index 0
    frame 1  observation.instances (936)  action (7)  chosen_index  ...   episode_index 0
    ...

`kitchen_prefs.instances` draws one instance set, whose rows stand one after the other here: all of
LeRobot's tools take a flat column, and none all of a two-dimensional one. In the second tier a set
has 1596 numbers, and the state one more. A set has no statistics: no
policy normalises a set, whose padding they would count. LeRobot adds timestamp, frame_index,
episode_index, index and task_index.
"""

import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from kitchen_prefs.datasets.names import is_of_people
from kitchen_prefs.envs.demonstrations import Demonstration
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE, STATE
from kitchen_prefs.envs.people_observations import PEOPLE_STATE
from kitchen_prefs.instances import DESCRIBED_FLAT_SIZE, FLAT_SIZE, as_rows

POSE_NAMES = ("x", "y", "z", "qw", "qx", "qy", "qz")
FPS = 1  # a decision has no duration; with 1 a timestamp is the decision's number
ROBOT_TYPE = "kitchen_prefs"
SETS = "observation.instances"


def _feature(dtype: str, shape: tuple[int, ...], names: Iterable[str] | None) -> dict[str, Any]:
    return {"dtype": dtype, "shape": shape, "names": None if names is None else list(names)}


FEATURES = {
    SETS: _feature("float32", (FLAT_SIZE,), None),
    "observation.environment_state": _feature(
        "float32", (len(ENVIRONMENT_STATE),), ENVIRONMENT_STATE
    ),
    "observation.state": _feature("float32", (len(STATE),), STATE),
    "action": _feature("float32", (len(POSE_NAMES),), POSE_NAMES),
    "chosen_index": _feature("int64", (1,), None),
    "preference": _feature("int64", (1,), None),
    "next.reward": _feature("float32", (1,), None),
    "next.done": _feature("bool", (1,), None),
    "next.success": _feature("bool", (1,), None),
}
PEOPLE_FEATURES = FEATURES | {
    SETS: _feature("float32", (DESCRIBED_FLAT_SIZE,), None),
    "observation.state": _feature("float32", (len(PEOPLE_STATE),), PEOPLE_STATE),
}
BOOKKEEPING = ("timestamp", "frame_index", "episode_index", "index", "task_index")


def features_of(name: str) -> dict[str, dict[str, Any]]:
    """The columns of a data set with a name, as LeRobot describes them."""
    return PEOPLE_FEATURES if is_of_people(name) else FEATURES


def columns_of(demonstration: Demonstration) -> dict[str, np.ndarray]:
    """The columns of one episode.

    Returns:
        For each of FEATURES, (T, ...); a feature of shape (1,) is (T,).
    """
    frames = len(demonstration.action)
    return {
        SETS: demonstration.instances.reshape(frames, -1),
        "observation.environment_state": demonstration.environment_state,
        "observation.state": demonstration.state,
        "action": demonstration.action,
        "chosen_index": demonstration.chosen_index,
        "preference": np.full(frames, demonstration.preference, dtype=np.int64),
        "next.reward": demonstration.reward,
        "next.done": demonstration.done,
        "next.success": demonstration.success,
    }


def with_statistics(columns: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The columns of which a data set has statistics: all but the sets."""
    return {name: values for name, values in columns.items() if name != SETS}


def read_columns(root: Path) -> dict[str, np.ndarray]:
    """Read all columns of a data set of either tier, in frame order.

    Args:
        root: The data set's folder.

    Returns:
        For each of FEATURES and BOOKKEEPING, (frames, ...); the sets are (frames, N, D).
    """
    return {name: _read_column(root, name) for name in (*FEATURES, *BOOKKEEPING)}


def _read_column(root: Path, name: str) -> np.ndarray:
    """One column alone: beside the sets of a large data set nothing else is held twice."""
    paths = sorted(root.glob("data/*/*.parquet"))
    table = pa.concat_tables([pq.read_table(path, columns=[name]) for path in paths])
    values = flat_numbers(table[name])
    if values.size == len(table):
        return values
    return as_rows(values.reshape(len(table), -1))


def read_tasks(root: Path) -> list[str]:
    """Read the tasks of a data set, in the order of their indices."""
    table = pq.read_table(root / "meta" / "tasks.parquet")
    by_index = zip(table["task_index"].to_pylist(), table["task"].to_pylist(), strict=True)
    return [task for _, task in sorted(by_index)]


def fingerprint(columns: dict[str, np.ndarray], tasks: list[str]) -> str:
    """The content fingerprint of a data set.

    It depends on the values alone, not on how parquet stores them.

    Args:
        columns: As from `read_columns`.
        tasks: As from `read_tasks`.

    Returns:
        A SHA-256 over the columns' names, types, shapes and values in frame order, and the tasks.
    """
    digest = hashlib.sha256()
    for name in sorted(columns):
        values = columns[name].astype(columns[name].dtype.newbyteorder("<"), copy=False)
        digest.update(f"{name} {values.dtype.str} {values.shape}\n".encode())
        digest.update(values.ravel().view(np.uint8))
    digest.update("\n".join(tasks).encode())
    return digest.hexdigest()


def flat_numbers(column: pa.ChunkedArray) -> np.ndarray:
    """All numbers of a column of any number of dimensions, flat."""
    array = column.combine_chunks()
    if isinstance(array, pa.ChunkedArray):
        array = pa.concat_arrays(array.chunks)
    if isinstance(array, pa.ExtensionArray):  # LeRobot's two-dimensional features
        array = array.storage
    while pa.types.is_nested(array.type):
        array = array.flatten()
    return array.to_numpy(zero_copy_only=False)

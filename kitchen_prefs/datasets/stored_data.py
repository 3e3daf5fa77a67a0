"""A data set as its files hold it, for verification."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from kitchen_prefs.datasets.certificates import read_certificates
from kitchen_prefs.datasets.columns import read_columns, read_tasks
from kitchen_prefs.datasets.manifest import read_manifest
from kitchen_prefs.datasets.names import Content, content_of, dataset_root
from kitchen_prefs.people.certificates import Certificate

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
        certificates: Of each episode; none in the first tier.
    """

    content: Content
    manifest: dict
    columns: dict[str, np.ndarray]
    tasks: list[str]
    stats: dict[str, dict]
    lengths: np.ndarray
    starts: np.ndarray
    ends: np.ndarray
    certificates: list[Certificate]

    def frames(self, episode: int) -> slice:
        """The frames of an episode."""
        start = int(self.lengths[:episode].sum())
        return slice(start, start + int(self.lengths[episode]))


def read_data(name: str) -> Data:
    """Read a data set.

    Args:
        name: The data set's name; it is not made if it is not there.

    Raises:
        ValueError: If it is not there, or not as it was written.
    """
    content = content_of(name)
    root = dataset_root(content.name)
    if not root.exists():
        raise ValueError(
            f"The data set {content.name} is not in {root.parent}; "
            f"`kitchen-prefs datasets make {content.name}` makes it."
        )
    manifest = read_manifest(content.name, root)
    lengths, starts, ends = _episode_facts(root)
    return Data(
        content,
        manifest,
        read_columns(root),
        read_tasks(root),
        json.loads((root / "meta" / "stats.json").read_text()),
        lengths,
        starts,
        ends,
        read_certificates(root) if content.is_of_people else [],
    )


def _episode_facts(root: Path) -> list[np.ndarray]:
    paths = sorted((root / "meta" / "episodes").glob("*/*.parquet"))
    table = pa.concat_tables([pq.read_table(path, columns=list(EPISODE_FACTS)) for path in paths])
    return [table[name].to_numpy() for name in EPISODE_FACTS]

"""The card of a data set: its format, its intended use and its limits.

Each tier has a template, `card.md` and `people_card.md`.
"""

import io
from collections.abc import Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from kitchen_prefs import instances
from kitchen_prefs.datasets.columns import FPS, SETS, features_of, read_columns
from kitchen_prefs.datasets.names import Content, data_version_of
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE
from kitchen_prefs.people.attributes import MATERIALS
from kitchen_prefs.people.certificates import SURE
from kitchen_prefs.people.splits import PEOPLE_SPLITS, PEOPLE_TEST_SPLITS, PeopleSplit
from kitchen_prefs.preferences import TWELVE
from kitchen_prefs.splits import SPLITS, TEST_SPLITS, Split


def card_facts(manifest: dict, root: Path) -> dict[str, Any]:
    """What a card says of its data set that cannot be known without it.

    Args:
        manifest: What the data set says about itself.
        root: Its folder, whose files are measured.

    Returns:
        Fingerprint, numbers of episodes and frames, and the bytes that a frame takes on disk.
    """
    of_manifest = {key: manifest[key] for key in ("fingerprint", "episodes", "frames")}
    return of_manifest | _bytes_a_frame(root)


def card(content: Content, facts: dict[str, Any]) -> str:
    """Write the card of a data set.

    Args:
        content: What it holds.
        facts: As from `card_facts`.

    Returns:
        The card in Markdown, with the header that the Hugging Face hub reads.
    """
    name = "people_card.md" if content.is_of_people else "card.md"
    template = (files("kitchen_prefs.datasets") / name).read_text()
    of_tier = _of_people(content) if content.is_of_people else _of_preferences(content)
    features = features_of(content.name)
    return template.format(
        name=content.name,
        purpose=content.purpose,
        version=data_version_of(content.name),
        fps=FPS,
        **facts,
        **of_tier,
        features=_features(features, PEOPLE_MEANINGS if content.is_of_people else MEANINGS),
        state=_numbered(features["observation.state"]["names"]),
        environment_state=_numbered(ENVIRONMENT_STATE),
    )


def _of_preferences(content: Content) -> dict[str, Any]:
    """What the first tier's card says beside what both say."""
    return {
        "preferences": _preferences(content),
        "counts": _counts({SPLITS[split].count(index) for split, index in content.sessions}),
        "capacity": instances.CAPACITY,
        "splits": _splits(content, SPLITS),
        "test_splits": _names(TEST_SPLITS),
        "noise": NOISE if any(SPLITS[split].noisy for split, _ in content.sessions) else "",
    }


def _of_people(content: Content) -> dict[str, Any]:
    """What the second tier's card says beside what both say."""
    counts = {PEOPLE_SPLITS[split].count(index) for split, index in content.sessions}
    users = {(split, PEOPLE_SPLITS[split].user(index)) for split, index in content.sessions}
    return {
        "users": len(users),
        "counts": _counts(counts),
        "capacity": instances.DESCRIBED_CAPACITY,
        "columns": instances.DESCRIBED_COLUMNS,
        "materials": ", ".join(MATERIALS),
        "sure": SURE,
        "splits": _splits(content, PEOPLE_SPLITS),
        "test_splits": _names(PEOPLE_TEST_SPLITS),
    }


def _preferences(content: Content) -> str:
    labels = {SPLITS[split].users[index] for split, index in content.sessions}
    twelve = sorted(label + 1 for label in labels if label < len(TWELVE))
    others = len(labels) - len(twelve)
    numbers = ", ".join(map(str, twelve))
    parts = [f"{len(twelve)} of the twelve preferences ({numbers})"] if twelve else []
    parts += [f"{others} others, drawn at random from the space of 2 x 7!"] if others else []
    return " and ".join(parts)


def _counts(counts: set[int]) -> str:
    return ", ".join(map(str, sorted(counts)))


def _names(splits: Iterable[str]) -> str:
    return ", ".join(f"`{name}`" for name in splits)


def _bytes_a_frame(root: Path) -> dict[str, int]:
    """The bytes that a frame takes on disk, those of its set, and those without the padding."""
    columns = read_columns(root)
    frames = len(columns["episode_index"])
    paths = list(root.glob("data/*/*.parquet"))
    return {
        "frame_bytes": round(sum(path.stat().st_size for path in paths) / frames),
        "set_bytes": round(sum(_set_bytes(path) for path in paths) / frames),
        "unpadded_set_bytes": round(_set_bytes(_without_padding(columns)) / frames),
    }


def _set_bytes(file: Path | io.BytesIO) -> int:
    """The compressed bytes of the instance sets in a parquet file."""
    metadata = pq.read_metadata(file)
    chunks = (
        metadata.row_group(group).column(column)
        for group in range(metadata.num_row_groups)
        for column in range(metadata.num_columns)
    )
    return sum(c.total_compressed_size for c in chunks if c.path_in_schema.startswith(SETS))


def _without_padding(columns: dict[str, np.ndarray]) -> io.BytesIO:
    """The instance sets as `writing` stores them, but with their own rows only."""
    file = io.BytesIO()
    schema = pa.schema({SETS: pa.list_(pa.float32())})
    starts = np.flatnonzero(columns["frame_index"] == 0)[1:]
    with pq.ParquetWriter(file, schema, compression="snappy") as writer:
        for padded in np.split(columns[SETS], starts):  # (T, N, D) an episode
            sets = [instances.unpad(one) for one in padded]
            ends = np.cumsum([0, *(one.size for one in sets)], dtype=np.int32)
            column = pa.ListArray.from_arrays(ends, pa.array(np.concatenate(sets).ravel()))
            writer.write_table(pa.Table.from_arrays([column], schema=schema))
    file.seek(0)
    return file


def _features(features: dict[str, dict[str, Any]], meanings: dict[str, str]) -> str:
    lines = [
        f"| `{name}` | {feature['dtype']} | {' x '.join(map(str, feature['shape']))} | "
        f"{meanings[name]} |"
        for name, feature in features.items()
    ]
    return "\n".join(lines)


def _numbered(names: Iterable[str]) -> str:
    return "\n".join(f"{number:5d}  {name}" for number, name in enumerate(names))


def _splits(content: Content, splits: Mapping[str, Split | PeopleSplit]) -> str:
    version = data_version_of(content.name)
    lines = [
        f"| `dishwasher-{name}-v{version}` | {split.sessions} | {split.purpose} |"
        for name, split in splits.items()
    ]
    return "\n".join(lines)


MEANINGS = {
    SETS: "the visible instances, see above",
    "observation.environment_state": "a flat summary of it, for policies that cannot read a set",
    "observation.state": "joints, category in hand, decision index",
    "action": "the pose of the chosen row: position (m), quaternion (wxyz)",
    "chosen_index": "the chosen row",
    "preference": "the preference's label: 0 to 11 the twelve, above them the others",
    "next.reward": "the paper's dense reward",
    "next.done": "true at the last decision",
    "next.success": "true at the last decision: all is loaded and closed",
}
PEOPLE_MEANINGS = MEANINGS | {
    "observation.state": "joints, category in hand, decision index, evening",
    "preference": "the user's number in the split",
    "next.reward": "1 for taking a dish that the user would take now, or one of its rank, and for "
    "its zone or the sink, else 0",
}

NOISE = """
The demonstrations are free of noise: the expert observes exact values and its picks succeed. The
noise of this split (extents, poses, failed picks) is the environment's.
"""

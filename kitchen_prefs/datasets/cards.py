"""The card of a data set: its format, its intended use and its limits."""

import io
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from kitchen_prefs import instances
from kitchen_prefs.datasets.columns import FEATURES, FPS, read_columns
from kitchen_prefs.datasets.names import Content
from kitchen_prefs.envs.observations import ENVIRONMENT_STATE, STATE
from kitchen_prefs.preferences import TWELVE
from kitchen_prefs.splits import DATA_VERSION, SPLITS, TEST_SPLITS


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
    template = (files("kitchen_prefs.datasets") / "card.md").read_text()
    return template.format(
        name=content.name,
        purpose=content.purpose,
        version=DATA_VERSION,
        fps=FPS,
        **facts,
        preferences=_preferences(content),
        counts=_counts(content),
        capacity=instances.CAPACITY,
        features=_features(),
        state=_numbered(STATE),
        environment_state=_numbered(ENVIRONMENT_STATE),
        splits=_splits(),
        test_splits=", ".join(f"`{name}`" for name in TEST_SPLITS),
        noise=NOISE if any(SPLITS[split].noisy for split, _ in content.sessions) else "",
    )


def _preferences(content: Content) -> str:
    labels = {SPLITS[split].users[index] for split, index in content.sessions}
    twelve = sorted(label + 1 for label in labels if label < len(TWELVE))
    others = len(labels) - len(twelve)
    numbers = ", ".join(map(str, twelve))
    parts = [f"{len(twelve)} of the twelve preferences ({numbers})"] if twelve else []
    parts += [f"{others} others, drawn at random from the space of 2 x 7!"] if others else []
    return " and ".join(parts)


def _counts(content: Content) -> str:
    counts = {SPLITS[split].count(index) for split, index in content.sessions}
    return ", ".join(map(str, sorted(counts)))


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
    name = "observation.instances"
    return sum(c.total_compressed_size for c in chunks if c.path_in_schema.startswith(name))


def _without_padding(columns: dict[str, np.ndarray]) -> io.BytesIO:
    """The instance sets as `writing` stores them, but with their own rows only."""
    file = io.BytesIO()
    schema = pa.schema({"observation.instances": pa.list_(pa.float32())})
    starts = np.flatnonzero(columns["frame_index"] == 0)[1:]
    with pq.ParquetWriter(file, schema, compression="snappy") as writer:
        for padded in np.split(columns["observation.instances"], starts):  # (T, N, 13) an episode
            sets = [instances.unpad(one) for one in padded]
            ends = np.cumsum([0, *(one.size for one in sets)], dtype=np.int32)
            column = pa.ListArray.from_arrays(ends, pa.array(np.concatenate(sets).ravel()))
            writer.write_table(pa.Table.from_arrays([column], schema=schema))
    file.seek(0)
    return file


def _features() -> str:
    lines = [
        f"| `{name}` | {feature['dtype']} | {' x '.join(map(str, feature['shape']))} | "
        f"{MEANINGS[name]} |"
        for name, feature in FEATURES.items()
    ]
    return "\n".join(lines)


def _numbered(names: tuple[str, ...]) -> str:
    return "\n".join(f"{number:5d}  {name}" for number, name in enumerate(names))


def _splits() -> str:
    lines = [
        f"| `dishwasher-{name}-v{DATA_VERSION}` | {split.sessions} | {split.purpose} |"
        for name, split in SPLITS.items()
    ]
    return "\n".join(lines)


MEANINGS = {
    "observation.instances": "the visible instances, see above",
    "observation.environment_state": "a flat summary of it, for policies that cannot read a set",
    "observation.state": "joints, category in hand, decision index",
    "action": "the pose of the chosen row: position (m), quaternion (wxyz)",
    "chosen_index": "the chosen row",
    "preference": "the preference's label: 0 to 11 the twelve, above them the others",
    "next.reward": "the paper's dense reward",
    "next.done": "true at the last decision",
    "next.success": "true at the last decision: all is loaded and closed",
}

NOISE = """
The demonstrations are free of noise: the expert observes exact values and its picks succeed. The
noise of this split (extents, poses, failed picks) is the environment's.
"""

"""The committed placements: where dishes can stand in a rack, and which places block each other.

`kitchen-prefs physics make-placements` made `placements.npz`; `placements.json` says how. Those of
the second tier, whose dishes vary in size, are for the largest: `placements_largest.npz`.
Reading them needs no MuJoCo.
"""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

LARGEST = 1.15  # by how much a dish of the second tier is at most larger than its extents
FILES = {1.0: "placements.npz", LARGEST: "placements_largest.npz"}


@dataclass(frozen=True)
class Placements:
    """P poses that dishes can take in either rack, sorted by category.

    Attributes:
        category: The index in `CATEGORIES` of the dish that fits, (P,) int8.
        position: In the rack's frame, whose origin is the middle of its floor, (P, 3) float32 m.
        quaternion: In the rack's frame, (P, 4) float32 wxyz with w >= 0.
        blocks: Whether two places cannot both be taken, (P, P) bool, True on the diagonal.
    """

    category: np.ndarray
    position: np.ndarray
    quaternion: np.ndarray
    blocks: np.ndarray


def placements_file(scale: float = 1.0) -> Path:
    """The file of the placements for dishes of a scale, 1 or LARGEST."""
    return Path(__file__).with_name(FILES[scale])


@cache
def load_placements(scale: float = 1.0) -> Placements:
    """The placements of the published kitchen; treat the arrays as read-only.

    Args:
        scale: By how much dishes are larger than their extents, 1 or LARGEST.
    """
    with np.load(placements_file(scale), allow_pickle=False) as arrays:
        placements = Placements(**{name: arrays[name] for name in Placements.__dataclass_fields__})
    for name in Placements.__dataclass_fields__:
        getattr(placements, name).setflags(write=False)
    return placements


def load_record(scale: float = 1.0) -> dict[str, Any]:
    """How the placements were made: seed, MuJoCo version, geometry hash, counts, truth check."""
    return json.loads(placements_file(scale).with_suffix(".json").read_text())

"""The committed placements: where dishes can stand in a rack, and which places block each other.

`kitchen-prefs physics make-placements` made `placements.npz`; `placements.json` says how.
Reading them needs no MuJoCo.
"""

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

PLACEMENTS_FILE = Path(__file__).with_name("placements.npz")
RECORD_FILE = PLACEMENTS_FILE.with_suffix(".json")


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


@cache
def load_placements() -> Placements:
    """The placements of the published kitchen; treat the arrays as read-only."""
    with np.load(PLACEMENTS_FILE, allow_pickle=False) as arrays:
        placements = Placements(**{name: arrays[name] for name in Placements.__dataclass_fields__})
    for name in Placements.__dataclass_fields__:
        getattr(placements, name).setflags(write=False)
    return placements


def load_record() -> dict[str, Any]:
    """How the placements were made: seed, MuJoCo version, geometry hash, counts, truth check."""
    return json.loads(RECORD_FILE.read_text())

"""How the placements are made: settle many, keep those farthest apart, test every pair."""

import hashlib
import platform
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import islice
from multiprocessing import get_context
from typing import Any

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation
from tqdm import tqdm

from kitchen_prefs.physics.blocking import blocking_table
from kitchen_prefs.physics.settling import Settler, rack_and_dish
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.placements import Placements, placements_file
from kitchen_prefs.utils.files import atomic_file, write_json

KEPT = 48  # of each category: instances.CAPACITY has room for so many places
BATCHES, PER_BATCH = 16, 10  # so 160 settled poses a category to keep from
# How much a turn by one radian weighs against a metre when poses are kept apart: a dish's size.
TURN_WEIGHT = 0.05


def make_placements(seed: int, scale: float = 1.0) -> Placements:
    """Make the placements anew, on all cores; about three minutes on two.

    Args:
        seed: Of every random drop.
        scale: By how much dishes are larger than their categories' extents.

    Returns:
        At most `KEPT` placements a category, in the order of CATEGORIES.
    """
    jobs = [(seed, c, batch, scale) for c in range(len(CATEGORIES)) for batch in range(BATCHES)]
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        batches = list(tqdm(pool.map(_settle_batch, jobs), "Settling dishes", len(jobs)))
    settled = np.concatenate(batches).reshape(len(CATEGORIES), -1, 7)
    kept = [_farthest_apart(name, poses) for name, poses in zip(CATEGORIES, settled, strict=True)]
    category = np.repeat(np.arange(len(CATEGORIES), dtype=np.int8), KEPT)
    poses = _canonical(np.concatenate(kept)).astype(np.float32)
    return Placements(category, poses[:, :3], poses[:, 3:], blocking_table(category, poses, scale))


def _settle_batch(job: tuple[int, int, int, float]) -> np.ndarray:
    """The settled poses of one batch, (PER_BATCH, 7); a job is (seed, category, batch, scale)."""
    *numbers, scale = job
    settler = Settler(CATEGORIES[job[1]], scale)
    return np.array(list(islice(settler.settled(np.random.default_rng(numbers)), PER_BATCH)))


def _farthest_apart(category: str, poses: np.ndarray) -> np.ndarray:
    """The `KEPT` of (n, 7) poses that farthest-point selection finds, the middle one first."""
    points = _comparable(category, poses)
    apart = np.linalg.norm(points[:, None] - points[None], axis=-1)  # (n, n)
    kept = [int(np.argmin(np.linalg.norm(poses[:, :2], axis=1)))]
    while len(kept) < KEPT:
        kept.append(int(np.argmax(apart[kept].min(axis=0))))
    return poses[kept]


def _comparable(category: str, poses: np.ndarray) -> np.ndarray:
    """Position and weighted axes, (n, 6 or 9): a round dish's spin does not count."""
    axes = Rotation.from_quat(poses[:, 3:], scalar_first=True).as_matrix()
    columns = [poses[:, :3], TURN_WEIGHT * axes[:, :, 2]]
    if category in ("cup", "tray"):
        columns.append(TURN_WEIGHT * axes[:, :, 0])
    return np.concatenate(columns, axis=1)


def _canonical(poses: np.ndarray) -> np.ndarray:
    """The same poses with w >= 0."""
    canonical = poses.copy()
    canonical[poses[:, 3] < 0, 3:] *= -1.0
    return canonical


def without(placements: Placements, rejected: np.ndarray) -> Placements:
    """The placements without those at some indices."""
    kept = np.setdiff1d(np.arange(len(placements.category)), rejected)
    return replace(
        placements,
        category=placements.category[kept],
        position=placements.position[kept],
        quaternion=placements.quaternion[kept],
        blocks=placements.blocks[np.ix_(kept, kept)],
    )


def geometry_hash(scale: float = 1.0) -> str:
    """A hash of every solid of the rack and the dishes: settled poses hold only for these."""
    sha = hashlib.sha256()
    for category in CATEGORIES:
        model = rack_and_dish(category, scale)
        for numbers in (model.geom_type, model.geom_size, model.geom_pos, model.geom_quat):
            # To a hundredth of a millimetre: no machine's rounding shows. -0.0 + 0.0 is 0.0.
            sha.update((np.round(numbers, 5) + 0.0).astype("<f8").tobytes())
    return sha.hexdigest()


def describe(placements: Placements, seed: int, scale: float = 1.0) -> dict[str, Any]:
    """The record that goes with new placements."""
    return {
        "seed": seed,
        "mujoco": mujoco.__version__,
        "machine": platform.machine(),
        "geometry": geometry_hash(scale),
        "settled": BATCHES * PER_BATCH,
        "counts": count(placements),
    }


def count(placements: Placements) -> dict[str, int]:
    """How many placements each category has."""
    return {name: int((placements.category == i).sum()) for i, name in enumerate(CATEGORIES)}


def save_placements(placements: Placements, record: dict[str, Any], scale: float = 1.0) -> None:
    """Write the placements and their record where `load_placements` finds them."""
    file = placements_file(scale)
    arrays = {name: getattr(placements, name) for name in Placements.__dataclass_fields__}
    with atomic_file(file) as unfinished:
        np.savez_compressed(unfinished, **arrays)
    write_json(file.with_suffix(".json"), record)

"""Checks under contact physics that dishes stay in place when a loaded rack slides in.

The kitchen moves a rack with its dishes as one rigid piece. Here all dishes of a load stand in the
rack together, settle, and the rack slides in under contact physics.
"""

from collections.abc import Sequence

import mujoco
import numpy as np

from kitchen_prefs.physics.dish_bodies import add_solids
from kitchen_prefs.physics.rack import add_wires
from kitchen_prefs.physics.settling import displacement, physics
from kitchen_prefs.simulation.layout import RACK_TRAVEL

SETTLING_TIME = 0.5  # s, all dishes together, before the rack moves
SLIDING_TIME = 4.0  # s: a quicker rack throws dishes about
RACK_ARMATURE = 1e4  # kg: dishes must not hold up a rack whose motion is given
STAY = (0.03, np.deg2rad(20.0))  # m, rad: a dish that moves more has not stayed


def carry(categories: Sequence[str], poses: np.ndarray, scale: float = 1.0) -> np.ndarray:
    """Load a rack that is pulled out, let everything settle, and slide the rack in.

    Args:
        categories: The categories of the n dishes.
        poses: Their position and quaternion (wxyz) in the rack's frame, (n, 7).
        scale: By how much they are larger than their categories' extents.

    Returns:
        Whether each dish stayed within `STAY` of its pose in the rack, (n,) bool.
    """
    model = _loaded_rack(categories, poses, scale)
    data = mujoco.MjData(model)
    while data.time < SETTLING_TIME + SLIDING_TIME:
        data.qpos[0], data.qvel[0] = _slide(data.time - SETTLING_TIME)
        mujoco.mj_step(model, data)
    after = data.qpos[1:].reshape(-1, 7).copy()
    after[:, 1] -= data.qpos[0]
    moved = np.array([displacement(*pair) for pair in zip(poses, after, strict=True)])  # (n, 2)
    return np.all(moved <= np.array(STAY), axis=1)


def _slide(time: float) -> tuple[float, float]:
    """The rack's displacement in m and its speed in m/s, at a time in s: of least jerk."""
    s = float(np.clip(time / SLIDING_TIME, 0.0, 1.0))
    way = s**3 * (10 - 15 * s + 6 * s**2)
    speed = 30 * s**2 * (1 - s) ** 2 / SLIDING_TIME
    return RACK_TRAVEL * way, RACK_TRAVEL * speed


def _loaded_rack(categories: Sequence[str], poses: np.ndarray, scale: float) -> mujoco.MjModel:
    spec = physics()
    rack = spec.worldbody.add_body(name="rack")
    rack.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=(0.0, 1.0, 0.0), armature=RACK_ARMATURE)
    add_wires(rack)
    for category, pose in zip(categories, poses, strict=True):
        dish = spec.worldbody.add_body(pos=pose[:3], quat=pose[3:])
        dish.add_freejoint()
        add_solids(dish, category, scale)
    return spec.compile()

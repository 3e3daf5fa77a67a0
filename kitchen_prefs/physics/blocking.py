"""Which placements exclude each other: all in one model, and one pass of collision detection.

Two places block each other where the dishes' solids, or their convex hulls, come closer than
`INFLATION`. The hulls keep a small bowl from nesting in a big one.
"""

import mujoco
import numpy as np

from kitchen_prefs.physics.dish_bodies import add_hull, add_solids
from kitchen_prefs.preferences import CATEGORIES

INFLATION = 0.002  # m: settled poses shift a little when dishes come in together
CONTACT_MEMORY = 4 * 2**30  # bytes of address space for the contacts of some 60,000 pairs


def blocking_table(category: np.ndarray, poses: np.ndarray, scale: float = 1.0) -> np.ndarray:
    """Test every pair of placements.

    Args:
        category: The index in `CATEGORIES` of each placement's dish, (P,).
        poses: Position and quaternion (wxyz) in the rack's frame, (P, 7).
        scale: By how much dishes are larger than their categories' extents.

    Returns:
        Whether two placements cannot both be taken, (P, P) bool, symmetric, True on the diagonal.
    """
    blocks = np.eye(len(poses), dtype=bool)
    for hulls in (False, True):
        blocks |= _touching(category, poses, hulls, scale)
    return blocks


def _touching(category: np.ndarray, poses: np.ndarray, hulls: bool, scale: float) -> np.ndarray:
    spec = mujoco.MjSpec()
    spec.memory = CONTACT_MEMORY
    for index, pose in zip(category, poses, strict=True):
        body = spec.worldbody.add_body(pos=pose[:3], quat=pose[3:])
        body.add_freejoint()  # MuJoCo does not test bodies that cannot move
        if hulls:
            add_hull(spec, body, CATEGORIES[index], scale)
        else:
            add_solids(body, CATEGORIES[index], scale)
    for geom in spec.geoms:
        geom.margin = INFLATION
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mujoco.mj_collision(model, data)
    close = data.contact.geom[data.contact.dist < INFLATION]
    first, second = (model.geom_bodyid[close] - 1).T
    touching = np.zeros((len(poses), len(poses)), dtype=bool)
    touching[first, second] = touching[second, first] = True
    return touching

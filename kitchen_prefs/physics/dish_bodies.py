"""The dishes as MuJoCo bodies."""

import mujoco
import numpy as np

from kitchen_prefs.physics.shapes import MASSES, hull_points, solids

KINDS = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
}
COLLISION_GROUP = 3  # MuJoCo's viewer hides group 3, and so does our renderer
# Sliding, torsional and rolling friction of wet ceramics on coated wire.
FRICTION = (0.6, 0.005, 0.0005)


def add_solids(body: mujoco.MjsBody, category: str, scale: float = 1.0) -> None:
    """Give a body the shape and the mass of a dish.

    Args:
        body: The body; its frame becomes the dish's frame.
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        scale: By how much the dish is larger than its category's extents.
    """
    parts = solids(category, scale)
    for part in parts:
        body.add_geom(
            type=KINDS[part.kind],
            size=(*part.size, 0.0)[:3],
            pos=part.position,
            quat=part.quaternion,
            mass=MASSES[category] * scale**3 / len(parts),
            friction=FRICTION,
            condim=6,
            group=COLLISION_GROUP,
        )


def add_hull(spec: mujoco.MjSpec, body: mujoco.MjsBody, category: str, scale: float = 1.0) -> None:
    """Give a body the convex hull of a dish, which lets no other dish nest in it.

    Args:
        spec: The model, which keeps one mesh a category.
        body: The body; its frame becomes the dish's frame.
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        scale: By how much the dish is larger than its category's extents.
    """
    name = f"{category} hull"
    if spec.mesh(name) is None:
        spec.add_mesh(name=name, uservert=hull_points(category, scale).astype(np.float32).ravel())
    body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, group=COLLISION_GROUP)

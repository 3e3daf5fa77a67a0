"""The dishes of this table: the kitchen's shapes in other sizes, and their colours.

Nobody's real dishes have the sizes of the simulated kitchen's; the robot has to map them.
"""

from typing import Literal

import mujoco
import numpy as np

from kitchen_prefs.physics.dish_bodies import KINDS
from kitchen_prefs.physics.shapes import MASSES, solids
from kitchen_prefs.rendering.meshes import Surface, add_surface
from kitchen_prefs.rendering.tableware import GLAZES, surface
from kitchen_prefs.simulation.layout import EXTENTS

Colours = Literal["distinct", "alike"]
Colour = tuple[float, float, float]

# Size by the kitchen's. The small bowl is nearly as wide as the big one: colours tell them apart.
SCALES = {
    "cup": 0.90,
    "glass": 0.90,
    "tray": 0.80,
    "small bowl": 0.85,
    "big bowl": 0.80,
    "small plate": 1.20,
    "big plate": 0.85,
}
DISTINCT: dict[str, Colour] = {
    "cup": (0.80, 0.13, 0.10),
    "glass": (0.25, 0.70, 0.75),
    "tray": (0.55, 0.30, 0.60),
    "small bowl": (0.13, 0.32, 0.75),
    "big bowl": (0.30, 0.58, 0.30),
    "small plate": (0.93, 0.88, 0.72),
    "big plate": (0.95, 0.62, 0.12),
}
# Bowls and plates of one white service: their tones differ by less than a lamp's change does.
ALIKE: dict[str, Colour] = DISTINCT | {
    "small bowl": (0.84, 0.84, 0.86),
    "big bowl": (0.90, 0.88, 0.84),
    "small plate": (0.93, 0.88, 0.76),
    "big plate": (0.86, 0.80, 0.70),
}
PALETTES: dict[Colours, dict[str, Colour]] = {"distinct": DISTINCT, "alike": ALIKE}

COLLISION_GROUP = 3  # which MuJoCo does not draw
# Sliding, torsional and rolling friction of glazed ceramics; .4 grasps as well.
FRICTION = (0.6, 0.005, 0.0002)
SIDES = 40  # facets round a dish


def real_extents(category: str) -> np.ndarray:
    """The full size of a dish of this table, (3,) m."""
    return SCALES[category] * np.array(EXTENTS[category])


def add_dish(spec: mujoco.MjSpec, name: str, category: str, colour: Colour) -> None:
    """Add a dish that moves freely; its frame has its origin in the middle of its box, z up.

    Args:
        spec: The model, which keeps one mesh a category.
        name: Of the body and its joint.
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        colour: RGB of its glaze.
    """
    body = spec.worldbody.add_body(name=name)
    body.add_freejoint(name=name)
    scale, parts = SCALES[category], solids(category)
    for part in parts:
        body.add_geom(
            type=KINDS[part.kind],
            size=(*(scale * np.array(part.size)), 0.0)[:3],
            pos=scale * np.array(part.position),
            quat=part.quaternion,
            mass=scale**3 * MASSES[category] / len(parts),
            friction=FRICTION,
            condim=4,
            group=COLLISION_GROUP,
        )
    _add_glaze(spec, body, category, colour)


def _add_glaze(spec: mujoco.MjSpec, body: mujoco.MjsBody, category: str, colour: Colour) -> None:
    """Give a dish the smooth surface that cameras see."""
    if spec.mesh(category) is None:
        shape = surface(category, SIDES)
        add_surface(spec, category, Surface(SCALES[category] * shape.vertices, shape.faces))
    spec.add_material(
        name=body.name,
        rgba=(*colour, 1.0),
        specular=0.5 * GLAZES[category].specular,
        shininess=GLAZES[category].shininess,
    )
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=category,
        material=body.name,
        contype=0,
        conaffinity=0,
        mass=0.0,
    )

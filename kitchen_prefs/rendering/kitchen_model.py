"""The whole kitchen as one MuJoCo model; `rendering` adds the dishes where a state has them."""

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.dishwasher import add_dishwasher
from kitchen_prefs.rendering.finishes import add_finishes
from kitchen_prefs.rendering.meshes import add_surface
from kitchen_prefs.rendering.parts import add_materials
from kitchen_prefs.rendering.room import add_room
from kitchen_prefs.rendering.tableware import surface


@dataclass(frozen=True)
class View:
    """What a camera sees.

    Attributes:
        position: The camera's, (3,) m.
        target: What is in the middle of the picture, (3,) m.
        angle: Its field of view, degrees, vertical.
    """

    position: tuple[float, float, float]
    target: tuple[float, float, float]
    angle: float


# The whole kitchen as somebody sees it who stands before it: all of the counter, and into both
# racks; and from above, each rack when it is out, and the sink.
VIEWS = {
    "kitchen": View((0.86, -3.05, 2.02), (-0.62, 0.10, 0.68), 41.0),
    "bottom": View((0.0, -0.75, 1.25), (0.0, -0.29, 0.22), 36.0),
    "top": View((0.0, -0.75, 1.58), (0.0, -0.29, 0.55), 36.0),
    "sink": View((-0.75, -0.10, 1.75), (-0.75, 0.31, 0.82), 36.0),
}


@dataclass(frozen=True)
class Quality:
    """What a frame costs.

    Attributes:
        samples: Of anti-aliasing, for each pixel.
        shadows: The shadow map's side in pixels; 0 for no shadows.
        sides: How many facets round things have.
    """

    samples: int
    shadows: int
    sides: int


def kitchen_spec(quality: Quality) -> mujoco.MjSpec:
    """Put the kitchen together.

    Args:
        quality: What a frame may cost.

    Returns:
        The specification. It has a mesh named after each category, and those of `finishes`, which
        no body uses.
    """
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.visual.quality.offsamples = quality.samples
    spec.visual.quality.shadowsize = max(quality.shadows, 1)
    spec.visual.quality.numslices = quality.sides
    spec.visual.quality.numstacks = quality.sides // 4  # most round things are straight wires
    spec.visual.map.shadowclip = 1.3  # the key light's shadows reach all of the counter
    spec.stat.center, spec.stat.extent = (-0.7, 0.0, 0.7), 2.2
    add_materials(spec)
    add_room(spec)
    add_dishwasher(spec)
    for category in CATEGORIES:
        add_surface(spec, category, surface(category, 2 * quality.sides))
    add_finishes(spec, 2 * quality.sides)
    _add_lights(spec, quality.shadows > 0)
    for name, view in VIEWS.items():
        _add_camera(spec, name, view)
    return spec


def _add_lights(spec: mujoco.MjSpec, shadows: bool) -> None:
    """A window's light from the front left, a weak fill from the right, and light all round."""
    spec.visual.headlight.ambient = (0.38, 0.38, 0.39)
    spec.visual.headlight.diffuse = (0.14, 0.14, 0.14)
    spec.visual.headlight.specular = (0.0, 0.0, 0.0)
    directional = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    spec.worldbody.add_light(
        name="window",
        type=directional,
        pos=(-2.6, -2.6, 3.6),
        dir=(0.50, 0.66, -0.80),
        diffuse=(0.62, 0.60, 0.56),
        specular=(0.35, 0.35, 0.33),
        castshadow=shadows,
    )
    spec.worldbody.add_light(
        name="fill",
        type=directional,
        pos=(2.0, -3.0, 2.5),
        dir=(-0.5, 0.8, -0.4),
        diffuse=(0.13, 0.14, 0.16),
        castshadow=False,
    )


def _add_camera(spec: mujoco.MjSpec, name: str, view: View) -> None:
    ahead = np.subtract(view.target, view.position)
    across = np.cross(ahead, (0.0, 0.0, 1.0))
    axes = np.stack([across, np.cross(across, ahead), -ahead], axis=1)  # a camera looks along -z
    turn = Rotation.from_matrix(axes / np.linalg.norm(axes, axis=0))
    spec.worldbody.add_camera(
        name=name, pos=view.position, quat=turn.as_quat(scalar_first=True), fovy=view.angle
    )

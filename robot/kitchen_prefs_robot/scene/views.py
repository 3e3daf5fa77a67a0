"""Three cameras round the table, the lamps, and a plain light room."""

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs_robot.scene.layout import FLOOR
from kitchen_prefs_robot.scene.tableware import Colour

FIELD_OF_VIEW = 42.0  # degrees, vertical: the colour camera of an Intel RealSense D435
ROOM = (0.93, 0.92, 0.90)
SHADOWS = 2048  # pixels of the shadow map's side; 4096 makes a small picture twice as slow


@dataclass(frozen=True)
class View:
    """Where a camera stands and what it looks at, (3,) m each."""

    position: tuple[float, float, float]
    target: tuple[float, float, float]


VIEWS = {
    "front": View((1.30, -0.35, 0.85), (0.46, -0.12, 0.02)),
    "right": View((0.25, -1.22, 0.92), (0.48, -0.02, 0.08)),
    "above": View((0.95, -0.62, 1.05), (0.44, -0.12, 0.00)),
}
CAMERAS = tuple(VIEWS)
PICTURE_SIZE = (320, 240)  # width and height in pixels: one is 4 mm wide on the table
VISITOR = "visitor"  # sees the whole robot; perception does not use it
VISITOR_VIEW = View((1.35, -1.30, 0.95), (0.36, 0.10, 0.22))


def add_views(spec: mujoco.MjSpec, lamp: Colour) -> None:
    """Add cameras, lamps and background.

    Args:
        spec: The model.
        lamp: RGB by which the lamps' light is multiplied.
    """
    for name, view in (*VIEWS.items(), (VISITOR, VISITOR_VIEW)):
        spec.worldbody.add_camera(
            name=name, pos=view.position, quat=_looking(view), fovy=FIELD_OF_VIEW
        )
    _add_lamps(spec, np.array(lamp))
    _add_room(spec)


def _looking(view: View) -> np.ndarray:
    """The quaternion (wxyz) of a camera, which looks along its own -z with y up."""
    ahead = np.subtract(view.target, view.position)
    across = np.cross(ahead, (0.0, 0.0, 1.0))
    axes = np.stack([across, np.cross(across, ahead), -ahead], axis=1)
    turn = Rotation.from_matrix(axes / np.linalg.norm(axes, axis=0))
    return turn.as_quat(scalar_first=True)


def _add_lamps(spec: mujoco.MjSpec, lamp: np.ndarray) -> None:
    """A bright ceiling: light from all round, a soft key light and a weak fill."""
    spec.visual.headlight.ambient = 0.42 * lamp
    spec.visual.headlight.diffuse = 0.10 * lamp
    spec.visual.headlight.specular = (0.0, 0.0, 0.0)
    directional = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    spec.worldbody.add_light(
        name="key",
        type=directional,
        pos=(0.6, -1.2, 2.4),
        dir=(-0.15, 0.45, -1.0),
        diffuse=0.42 * lamp,
        specular=0.25 * lamp,
        castshadow=True,
    )
    spec.worldbody.add_light(
        name="fill",
        type=directional,
        pos=(2.0, 0.5, 2.0),
        dir=(-0.8, -0.2, -0.7),
        diffuse=0.20 * lamp,
        castshadow=False,
    )


def _add_room(spec: mujoco.MjSpec) -> None:
    """A floor that fades into a wall of one colour."""
    spec.add_texture(
        name="room",
        type=mujoco.mjtTexture.mjTEXTURE_SKYBOX,
        builtin=mujoco.mjtBuiltin.mjBUILTIN_FLAT,
        rgb1=ROOM,
        rgb2=ROOM,
        width=64,
        height=64,
    )
    spec.add_material(name="floor", rgba=(0.72, 0.70, 0.67, 1.0), specular=0.0)
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=(6.0, 6.0, 0.1),
        pos=(0.0, 0.0, FLOOR),
        material="floor",
        contype=0,
        conaffinity=0,
    )
    spec.visual.quality.shadowsize = SHADOWS
    spec.visual.quality.offsamples = 4
    spec.visual.rgba.haze = (*ROOM, 1.0)
    spec.visual.map.shadowclip = 1.5
    spec.visual.map.znear, spec.visual.map.zfar = 0.05, 12.0
    spec.stat.center, spec.stat.extent = (0.4, 0.0, 0.2), 1.2

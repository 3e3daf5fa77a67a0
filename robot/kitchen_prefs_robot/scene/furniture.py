"""The table, the cabinet with its two drawers, and the stands."""

from collections.abc import Sequence
from functools import cache

import mujoco
import numpy as np

from kitchen_prefs.rendering.meshes import add_surface, box
from kitchen_prefs.rendering.textures import walnut
from kitchen_prefs_robot.scene import layout

WOOD_TILE = 1.2  # m that one repetition of the wood's texture covers
# Colour (RGB), specular, shininess.
MATERIALS = {
    "cabinet": ((0.33, 0.43, 0.41), 0.15, 0.2),
    "front": ((0.37, 0.48, 0.46), 0.15, 0.2),
    "drawer": ((0.80, 0.79, 0.76), 0.10, 0.1),
    "steel": ((0.30, 0.31, 0.33), 0.60, 0.5),
    "stand": ((0.20, 0.20, 0.22), 0.20, 0.3),
}
GAP = 0.002  # m between a drawer's front and the cabinet's boards
DRAWER_DENSITY = 500.0  # kg / m³ of plywood
# A slide of plastic on wood: N to start it, N s / m while it moves.
SLIDE_FRICTION, SLIDE_DAMPING = 1.0, 8.0


def add_furniture(spec: mujoco.MjSpec) -> None:
    """Build the table and the cabinet."""
    for name, (colour, specular, shininess) in MATERIALS.items():
        spec.add_material(name=name, rgba=(*colour, 1.0), specular=specular, shininess=shininess)
    _add_table(spec)
    cabinet = spec.worldbody.add_body(
        name="cabinet",
        pos=layout.CABINET_POSITION,
        quat=layout.CABINET_ROTATION.as_quat(scalar_first=True),
    )
    _add_boards(cabinet)
    for drawer in layout.DRAWERS:
        _add_drawer(cabinet, drawer)


def add_stand(spec: mujoco.MjSpec, name: str, place: tuple[float, float]) -> None:
    """Put a column on the table, x and y of its axis."""
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=(layout.STAND_RADIUS, layout.STAND_HEIGHT / 2, 0.0),
        pos=(*place, layout.STAND_HEIGHT / 2),
        material="stand",
    )


@cache
def _wood() -> np.ndarray:
    """Drawn once in a process, as it takes as long as a second of physics."""
    return walnut()


def _add_table(spec: mujoco.MjSpec) -> None:
    """A wooden top, drawn as a mesh that carries the texture and felt as a box."""
    picture = _wood()
    texture = spec.add_texture(
        name="wood",
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        height=picture.shape[0],
        width=picture.shape[1],
        nchannel=3,
    )
    texture.data = picture.tobytes()
    spec.add_material(name="wood", specular=0.1, shininess=0.2).textures[
        mujoco.mjtTextureRole.mjTEXROLE_RGB
    ] = "wood"
    (left, right), (near, far) = layout.TABLE_X, layout.TABLE_Y
    low, high = (left, near, -layout.TABLE_THICKNESS), (right, far, 0.0)
    add_surface(spec, "table", box(low, high, WOOD_TILE))
    spec.worldbody.add_geom(
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname="table",
        material="wood",
        contype=0,
        conaffinity=0,
    )
    _add_box(spec.worldbody, "wood", low, high, group=3)


def _add_boards(cabinet: mujoco.MjsBody) -> None:
    """Sides, back, top, bottom and the shelf between the drawers."""
    depth, width, height = layout.CABINET_SIZE
    board, half = layout.BOARD, width / 2
    inner = half - board
    shelf = layout.DRAWER_FLOOR["upper"] - 0.012
    for low, high in (
        ((-depth, -half, 0.0), (0.0, -half + board, height)),
        ((-depth, half - board, 0.0), (0.0, half, height)),
        ((-depth, -inner, 0.0), (-depth + board, inner, height)),
        ((board - depth, -inner, height - board), (0.0, inner, height)),
        ((board - depth, -inner, 0.0), (0.0, inner, 0.02)),
        ((board - depth, -inner, shelf - board), (-0.02, inner, shelf)),
    ):
        _add_box(cabinet, "cabinet", low, high)


def _add_drawer(cabinet: mujoco.MjsBody, name: str) -> None:
    """A drawer on its slide: floor, walls, front and handle."""
    drawer = cabinet.add_body(name=name)
    drawer.add_joint(
        name=name,
        type=mujoco.mjtJoint.mjJNT_SLIDE,
        axis=(1, 0, 0),
        range=(0.0, layout.DRAWER_TRAVEL),
        limited=True,
        frictionloss=SLIDE_FRICTION,
        damping=SLIDE_DAMPING,
    )
    depth, width, height = layout.DRAWER_INNER
    wall, half, floor = layout.DRAWER_WALL, width / 2, layout.DRAWER_FLOOR[name]
    for low, high in (
        ((-depth - wall, -half - wall, floor - wall), (0.0, half + wall, floor)),
        ((-depth - wall, -half - wall, floor), (0.0, -half, floor + height)),
        ((-depth - wall, half, floor), (0.0, half + wall, floor + height)),
        ((-depth - wall, -half, floor), (-depth, half, floor + height)),
    ):
        _add_box(drawer, "drawer", low, high, density=DRAWER_DENSITY)
    side = layout.CABINET_SIZE[1] / 2 - layout.BOARD - GAP
    bottom = floor - 0.010
    low, high = (0.0, -side, bottom), (layout.BOARD, side, bottom + layout.FRONT_HEIGHT)
    _add_box(drawer, "front", low, high, density=DRAWER_DENSITY)
    _add_handle(drawer, floor + layout.HANDLE_UP)


def _add_handle(drawer: mujoco.MjsBody, height: float) -> None:
    """A round bar before the front, held at both ends."""
    out, half = layout.HANDLE_OUT, layout.HANDLE_LENGTH / 2
    ends = [(out, -half, height), (out, half, height)]
    feet = [(layout.BOARD, *end[1:]) for end in ends]
    for start, end in (ends, *zip(feet, ends, strict=True)):
        drawer.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=(*start, *end),
            size=(layout.HANDLE_RADIUS, 0.0, 0.0),
            material="steel",
            density=DRAWER_DENSITY,
        )


def _add_box(
    body: mujoco.MjsBody,
    material: str,
    low: Sequence[float],
    high: Sequence[float],
    **attributes: float,
) -> None:
    """Add a box between two opposite corners, (3,) m each."""
    first, last = np.array(low), np.array(high)
    body.add_geom(
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=(first + last) / 2,
        size=(last - first) / 2,
        material=material,
        **attributes,
    )

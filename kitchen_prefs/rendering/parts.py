"""What furniture is made of: materials, boxes, bars and textured slabs."""

from collections.abc import Sequence

import mujoco
import numpy as np

from kitchen_prefs.rendering import textures
from kitchen_prefs.rendering.meshes import add_surface, box

# Colour (RGB), specular, shininess. None reflects: reflectance makes a frame four times slower.
MATERIALS = {
    "cabinet": ((0.33, 0.43, 0.41), 0.15, 0.2),
    "cabinet frame": ((0.35, 0.45, 0.43), 0.15, 0.2),
    "dark": ((0.09, 0.10, 0.11), 0.30, 0.4),
    "steel": ((0.70, 0.72, 0.75), 0.70, 0.6),
    "basin": ((0.63, 0.65, 0.68), 0.50, 0.4),
    "liner": ((0.52, 0.55, 0.60), 0.40, 0.4),
    "door inside": ((0.66, 0.69, 0.73), 0.40, 0.4),
    "wall": ((0.90, 0.87, 0.81), 0.00, 0.0),
    "leaf": ((0.33, 0.52, 0.27), 0.10, 0.2),
    "terracotta": ((0.78, 0.43, 0.30), 0.10, 0.2),
}
# Texture, metres that one repetition covers, specular, shininess.
TEXTURED = {
    "oak": (textures.oak_floor, 2.4, 0.15, 0.2),
    "walnut": (textures.walnut, 1.2, 0.25, 0.3),
    "beech": (textures.beech, 0.5, 0.15, 0.2),
    "tiles": (textures.tiles, 0.6, 0.35, 0.5),
}


def add_materials(spec: mujoco.MjSpec) -> None:
    """Add every material that the furniture uses, with its texture."""
    for name, (colour, specular, shininess) in MATERIALS.items():
        spec.add_material(name=name, rgba=(*colour, 1.0), specular=specular, shininess=shininess)
    for name, (draw, _, specular, shininess) in TEXTURED.items():
        add_textured_material(spec, name, draw(), specular, shininess)


def add_textured_material(
    spec: mujoco.MjSpec, name: str, image: np.ndarray, specular: float, shininess: float
) -> None:
    """Add a material with a texture, (H, W, 3) uint8."""
    texture = spec.add_texture(
        name=name,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        height=image.shape[0],
        width=image.shape[1],
        nchannel=3,
    )
    texture.data = image.tobytes()
    material = spec.add_material(name=name, specular=specular, shininess=shininess)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name


def add_box(
    body: mujoco.MjsBody, material: str, low: Sequence[float], high: Sequence[float]
) -> None:
    """Add a box of one colour between two opposite corners, (3,) m each."""
    first, last = np.array(low), np.array(high)
    _add(
        body,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=(first + last) / 2,
        size=(last - first) / 2,
        material=material,
    )


def add_slab(
    spec: mujoco.MjSpec, name: str, material: str, low: Sequence[float], high: Sequence[float]
) -> None:
    """Add a textured box to the world between two opposite corners, (3,) m each."""
    add_surface(spec, name, box(low, high, TEXTURED[material][1]))
    add_mesh(spec.worldbody, name, material)


def add_mesh(body: mujoco.MjsBody, mesh: str, material: str) -> None:
    """Add a mesh of the model to a body."""
    _add(body, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh, material=material)


def add_bar(
    body: mujoco.MjsBody, material: str, start: Sequence[float], end: Sequence[float], radius: float
) -> None:
    """Add a round bar between two points, (3,) m each."""
    _add(
        body,
        type=mujoco.mjtGeom.mjGEOM_CAPSULE,
        fromto=(*start, *end),
        size=(radius, 0.0, 0.0),
        material=material,
    )


def _add(body: mujoco.MjsBody, **attributes: object) -> None:
    """Add a visual geom, which nothing collides with."""
    body.add_geom(contype=0, conaffinity=0, mass=0.0, **attributes)

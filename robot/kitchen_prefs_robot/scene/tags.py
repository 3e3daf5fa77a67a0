"""Four AprilTags of the family 36h11 on the table, from which the cameras find their poses."""

from dataclasses import dataclass

import cv2
import mujoco
import numpy as np
from scipy.spatial.transform import Rotation

from kitchen_prefs.rendering.meshes import Surface, add_surface

SIZE = 0.08  # m, the side of a tag's black square
PAPER = 0.10  # m, the side of the white paper round it, which a detector needs
CELLS = 8  # a tag's side in cells of its pattern, its black border included
PIXELS = 32  # of a cell in the texture
THICKNESS = 0.001  # m


@dataclass(frozen=True)
class Tag:
    """A tag's pose: x to the right of its picture, y to its top, z out of it.

    Attributes:
        position: Of its middle, (3,) m.
        quaternion: (4,) wxyz.
    """

    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


# By number; round the counter, where all cameras see them and no dish covers one.
TAGS = {
    0: Tag((0.24, -0.36, THICKNESS)),
    1: Tag((0.24, 0.14, THICKNESS)),
    2: Tag((0.74, -0.30, THICKNESS)),
    3: Tag((0.70, 0.10, THICKNESS)),
}


def tag_corners(number: int) -> np.ndarray:
    """The corners of a tag's black square, (4, 3) m.

    They come in the order of OpenCV's detector: top left, top right, bottom right, bottom left.
    """
    tag = TAGS[number]
    square = SIZE / 2 * np.array([(-1, 1, 0), (1, 1, 0), (1, -1, 0), (-1, -1, 0)])
    turn = Rotation.from_quat(tag.quaternion, scalar_first=True)
    return turn.apply(square) + tag.position


def add_tags(spec: mujoco.MjSpec) -> None:
    """Lay the tags on the table; nothing collides with them."""
    half = PAPER / 2
    corners = [(x, y, z) for z in (-THICKNESS, 0.0) for y in (-half, half) for x in (-half, half)]
    faces = [(4, 5, 7), (4, 7, 6), (0, 2, 3), (0, 3, 1)]  # MuJoCo wants a solid: a lid and a bottom
    texture = [((x + half) / PAPER, (half - y) / PAPER) for x, y, _ in corners]
    add_surface(spec, "tag", Surface(np.array(corners), np.array(faces), np.array(texture)))
    for number, tag in TAGS.items():
        name = f"tag {number}"
        _add_material(spec, name, _picture(number))
        spec.worldbody.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname="tag",
            material=name,
            pos=tag.position,
            quat=tag.quaternion,
            contype=0,
            conaffinity=0,
        )


def _picture(number: int) -> np.ndarray:
    """The tag on its paper, (H, W, 3) uint8."""
    family = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    black = cv2.aruco.generateImageMarker(family, number, CELLS * PIXELS)
    margin = round(CELLS * PIXELS * (PAPER / SIZE - 1) / 2)
    grey = np.pad(black, margin, constant_values=255)
    return np.repeat(grey[..., None], 3, axis=2)


def _add_material(spec: mujoco.MjSpec, name: str, picture: np.ndarray) -> None:
    height, width, channels = picture.shape
    texture = spec.add_texture(
        name=name,
        type=mujoco.mjtTexture.mjTEXTURE_2D,
        height=height,
        width=width,
        nchannel=channels,
    )
    texture.data = picture.tobytes()
    material = spec.add_material(name=name, specular=0.0, shininess=0.0)
    material.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = name

"""Visual meshes: turned dishes, tubes and textured boxes as triangles."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.interpolate import PchipInterpolator


@dataclass(frozen=True, eq=False)
class Surface:
    """A closed surface of triangles.

    Attributes:
        vertices: (V, 3) m.
        faces: Corners in counter-clockwise order seen from outside, (F, 3) int.
        texture: The place of each vertex on its texture, (V, 2), or None.
    """

    vertices: np.ndarray
    faces: np.ndarray
    texture: np.ndarray | None = None


def smooth(points: Sequence[tuple[float, float]], count: int) -> np.ndarray:
    """A smooth line through points, (count, 2), at even steps of length."""
    corners = np.array(points)
    length = np.insert(np.cumsum(np.hypot(*np.diff(corners, axis=0).T)), 0, 0.0)
    return PchipInterpolator(length, corners)(np.linspace(0.0, length[-1], count))


def turned(outline: np.ndarray, sides: int, centre: float = 0.0, stretch: float = 0.0) -> Surface:
    """Turn an outline about the z axis, as on a lathe.

    Args:
        outline: (n, 2) points (radius, z) from the axis below, along the outside and back to the
            axis along the inside.
        sides: How many facets go round.
        centre: x of the axis, m.
        stretch: How much wider than in x the half width is in y at the rim, m.

    Returns:
        The closed surface.
    """
    angles = 2 * np.pi * np.arange(sides) / sides
    radius, height = outline[1:-1].T
    oval = 1.0 + stretch / radius.max()
    x = centre + np.outer(radius, np.cos(angles))
    y = np.outer(radius, np.sin(angles)) * oval
    z = np.repeat(height[:, None], sides, axis=1)
    rings = np.stack([x, y, z], axis=-1).reshape(-1, 3)
    poles = np.array([[centre, 0.0, outline[0, 1]], [centre, 0.0, outline[-1, 1]]])
    return Surface(np.concatenate([rings, poles]), _between_rings(len(radius), sides))


def tube(path: np.ndarray, radius: float, sides: int) -> Surface:
    """A tube with closed ends along a middle line.

    Args:
        path: (n, 3) points.
        radius: Of the tube, m.
        sides: How many facets go round.

    Returns:
        The closed surface.
    """
    angles = 2 * np.pi * np.arange(sides) / sides
    along = np.gradient(path, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    # Every tube here lies in a plane, so the plane's normal is across all the way.
    normal = np.linalg.svd(path - path.mean(axis=0))[2][-1]
    across = np.cross(normal, along)
    round_about = np.cos(angles)[:, None, None] * across + np.sin(angles)[:, None, None] * normal
    rings = (path + radius * round_about).swapaxes(0, 1).reshape(-1, 3)
    return Surface(np.concatenate([rings, path[[0, -1]]]), _between_rings(len(path), sides))


def _between_rings(rings: int, sides: int) -> np.ndarray:
    """The triangles between rings of vertices and the two poles that come after them."""
    first = np.arange(sides)
    following = (first + 1) % sides
    faces = []
    for ring in range(rings - 1):
        low, high = ring * sides, (ring + 1) * sides
        faces.append(np.stack([low + first, low + following, high + following], axis=1))
        faces.append(np.stack([low + first, high + following, high + first], axis=1))
    start, last = rings * sides, (rings - 1) * sides
    faces.append(np.stack([np.full(sides, start), following, first], axis=1))
    faces.append(np.stack([np.full(sides, start + 1), last + first, last + following], axis=1))
    return np.concatenate(faces)


def box(low: Sequence[float], high: Sequence[float], tile: float = 1.0) -> Surface:
    """A box with a texture laid flat on every side.

    Args:
        low: Its corner with the least coordinates, (3,) m.
        high: The opposite corner, (3,) m.
        tile: How many metres one repetition of the texture covers.

    Returns:
        The closed surface.
    """
    corners = np.array([low, high], dtype=float)
    vertices: list[np.ndarray] = []
    faces: list[list[int]] = []
    texture: list[np.ndarray] = []
    for axis in range(3):
        across, up = [other for other in range(3) if other != axis]
        for side in (0, 1):
            square = np.zeros((4, 3))
            square[:, axis] = corners[side, axis]
            square[:, across] = corners[[0, 1, 1, 0], across]
            square[:, up] = corners[[0, 0, 1, 1], up]
            first = 4 * len(vertices)
            outwards = (side == 1) != (axis == 1)
            order = (0, 1, 2, 0, 2, 3) if outwards else (0, 2, 1, 0, 3, 2)
            vertices.append(square)
            faces += [[first + order[0], first + order[1], first + order[2]]]
            faces += [[first + order[3], first + order[4], first + order[5]]]
            texture.append(square[:, [across, up]] / tile)
    return Surface(np.concatenate(vertices), np.array(faces), np.concatenate(texture))


def joined(surfaces: Iterable[Surface]) -> Surface:
    """Several surfaces as one; it is textured if all of them are."""
    vertices: list[np.ndarray] = []
    faces: list[np.ndarray] = []
    textures: list[np.ndarray] = []
    count = 0
    for surface in surfaces:
        vertices.append(surface.vertices)
        faces.append(surface.faces + count)
        count += len(surface.vertices)
        if surface.texture is not None:
            textures.append(surface.texture)
    texture = np.concatenate(textures) if len(textures) == len(vertices) else None
    return Surface(np.concatenate(vertices), np.concatenate(faces), texture)


def add_surface(spec: mujoco.MjSpec, name: str, surface: Surface) -> None:
    """Add a surface to a model's meshes under a name."""
    mesh = spec.add_mesh(
        name=name,
        uservert=surface.vertices.astype(np.float32).ravel(),
        userface=surface.faces.astype(np.int32).ravel(),
        inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
    )
    if surface.texture is not None:
        mesh.usertexcoord = surface.texture.astype(np.float32).ravel()
        mesh.userfacetexcoord = surface.faces.astype(np.int32).ravel()

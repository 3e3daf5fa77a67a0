"""What lies on a dish of the second tier: a rim of another colour, and stains, as thin surfaces."""

from itertools import product

import numpy as np

from kitchen_prefs.rendering.meshes import Surface
from kitchen_prefs.simulation.layout import EXTENTS

RIM_LIFT, STAIN_LIFT = 0.0006, 0.0012  # m above the dish: stains lie on rims, too
STAINS = 14  # on a dish
STAIN_RADII = (0.035, 0.085)  # by the root of the dish's area
STAIN_SEED = 17
WAVE_LENGTH, WAVE_HEIGHT = 0.008, 0.09  # of the stains' edges: m, and a share of the radius


def rim(category: str, dish: Surface, share: float) -> Surface:
    """The upper part of a dish's surface, of a plate the outer one, in and out.

    Args:
        category: The dish's.
        dish: Its surface.
        share: How much of the height, or of a plate's radius, the rim has.
    """
    within = 2 * dish.vertices / EXTENTS[category]  # (V, 3), from -1 to 1
    if category.endswith("plate"):
        outwards = np.hypot(within[:, 0], within[:, 1])  # (V,)
    else:
        outwards = (within[:, 2] + 1) / 2
    return _part(_lifted(dish, RIM_LIFT), outwards - (1 - share))


def stains(category: str, dish: Surface) -> Surface:
    """Stains all over a dish's surface, drawn by a seed; through a wall they meet."""
    generator = np.random.default_rng([STAIN_SEED, *category.encode()])
    areas = np.linalg.norm(_normals(dish), axis=1) / 2  # (F,)
    chosen = generator.choice(len(areas), STAINS, p=areas / areas.sum())
    centres = dish.vertices[dish.faces[chosen]].mean(axis=1)  # (STAINS, 3)
    radii = generator.uniform(*STAIN_RADII, STAINS) * np.sqrt(areas.sum())
    distance = np.linalg.norm(dish.vertices[:, None] - centres, axis=-1)  # (V, STAINS)
    waves = np.sin(dish.vertices / WAVE_LENGTH).sum(axis=1)  # (V,)
    inside = (1 - distance / radii).max(axis=1) + WAVE_HEIGHT * waves
    return _part(_lifted(dish, STAIN_LIFT), inside)


def subdivided(surface: Surface, times: int) -> Surface:
    """The same surface with every triangle cut into four, so many times."""
    vertices, faces = surface.vertices, surface.faces
    for _ in range(times):
        corners = vertices[faces]  # (F, 3, 3)
        middles = (corners + np.roll(corners, -1, axis=1)) / 2
        vertices = np.concatenate([corners, middles], axis=1).reshape(-1, 3)  # (6 F, 3)
        four = np.array([(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)])
        faces = (6 * np.arange(len(corners))[:, None, None] + four).reshape(-1, 3)  # (4 F, 3)
    return Surface(vertices, faces)


def _normals(surface: Surface) -> np.ndarray:
    """The normal of each triangle, twice as long as its area, (F, 3)."""
    first, second, third = surface.vertices[surface.faces].swapaxes(0, 1)
    return np.cross(second - first, third - first)


def _lifted(surface: Surface, distance: float) -> Surface:
    """A surface moved outwards, m."""
    normals = np.zeros_like(surface.vertices)
    for corner in surface.faces.T:
        np.add.at(normals, corner, _normals(surface))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Surface(surface.vertices + distance * normals, surface.faces)


def _part(surface: Surface, values: np.ndarray) -> Surface:
    """The part of a surface on which values, given at its vertices, (V,), are positive."""
    corners, at = surface.vertices[surface.faces], values[surface.faces]  # (F, 3, 3), (F, 3)
    triangles = []
    for inside in product((False, True), repeat=3):
        alike = ((at > 0) == inside).all(axis=1)
        ring = [_crossing(corners[alike], at[alike], *edge) for edge in _edges_of_part(inside)]
        triangles += [
            np.stack([ring[0], ring[last - 1], ring[last]], axis=1) for last in range(2, len(ring))
        ]
    vertices, numbers = np.unique(
        np.concatenate(triangles).reshape(-1, 3).round(6), axis=0, return_inverse=True
    )
    faces = numbers.reshape(-1, 3)
    has_area = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
    return Surface(vertices, faces[has_area])


def _edges_of_part(inside: tuple[bool, ...]) -> list[tuple[int, int]]:
    """The corners of a triangle's part: its own corners, (i, i), and points between two, (i, j)."""
    edges = []
    for corner, following in ((0, 1), (1, 2), (2, 0)):
        if inside[corner]:
            edges.append((corner, corner))
        if inside[corner] != inside[following]:
            edges.append((corner, following))
    return edges


def _crossing(corners: np.ndarray, at: np.ndarray, start: int, end: int) -> np.ndarray:
    """Where the value is 0 between two corners of triangles, or the corner itself, (F, 3)."""
    if start == end:
        return corners[:, start]
    way = at[:, start] / (at[:, start] - at[:, end])
    return corners[:, start] + way[:, None] * (corners[:, end] - corners[:, start])

"""How the dishes look: their outlines for the lathe, and the colours that they come in."""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs.physics.shapes import CUP_CENTRE, CUP_RADIUS, HANDLE_RADIUS, cup_handle
from kitchen_prefs.rendering.meshes import Surface, joined, smooth, tube, turned
from kitchen_prefs.rendering.meshes import box as box_surface
from kitchen_prefs.simulation.layout import EXTENTS

TRAY_MATERIAL = "beech"  # its texture, tinted by the tray's colour
TRAY_TEXTURE = 0.5  # m that one repetition of it covers
COLOUR_SEED = 3  # of the colours by dish number


@dataclass(frozen=True)
class Glaze:
    """The colours that a category comes in, RGBA, and how it shines (0 to 1)."""

    colours: tuple[tuple[float, float, float, float], ...]
    specular: float
    shininess: float


WHITE, CREAM = (0.94, 0.94, 0.92, 1.0), (0.93, 0.88, 0.77, 1.0)
BLUE, SKY, NAVY = (0.20, 0.42, 0.75, 1.0), (0.55, 0.75, 0.90, 1.0), (0.14, 0.25, 0.45, 1.0)
RED, YELLOW, TEAL = (0.86, 0.20, 0.15, 1.0), (0.95, 0.71, 0.14, 1.0), (0.08, 0.50, 0.55, 1.0)
CORAL, SAGE, PLUM = (0.94, 0.47, 0.36, 1.0), (0.45, 0.62, 0.42, 1.0), (0.48, 0.22, 0.42, 1.0)

GLAZES = {
    "cup": Glaze((RED, YELLOW, TEAL, CORAL, NAVY), 0.6, 0.7),
    "glass": Glaze(
        ((0.62, 0.85, 0.92, 0.42), (0.70, 0.92, 0.80, 0.42), (0.85, 0.92, 0.95, 0.40)), 1.0, 0.9
    ),
    "tray": Glaze(((0.62, 0.45, 0.33, 1.0), (1.0, 0.88, 0.70, 1.0)), 0.15, 0.2),
    "small bowl": Glaze((SKY, CORAL, CREAM, TEAL), 0.6, 0.7),
    "big bowl": Glaze((SAGE, BLUE, YELLOW, PLUM), 0.6, 0.7),
    "small plate": Glaze((SKY, CREAM, SAGE, CORAL), 0.6, 0.7),
    "big plate": Glaze((WHITE, BLUE, CREAM), 0.6, 0.7),
}


def colour(category: str, number: int) -> tuple[float, float, float, float]:
    """The RGBA colour of a dish, which its number in the session draws."""
    colours = GLAZES[category].colours
    return colours[np.random.default_rng([COLOUR_SEED, number]).integers(len(colours))]


def surface(category: str, sides: int) -> Surface:
    """The dish as a smooth surface within its extents.

    Args:
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        sides: How many facets go round a dish; the outline gets as many points.

    Returns:
        The surface in the dish's frame.
    """
    width, depth, height = EXTENTS[category]
    stretch = (depth - width) / 2
    if category == "tray":
        return _tray()
    if category == "cup":
        mug = turned(_cup_outline(sides), sides, CUP_CENTRE)
        return joined([mug, tube(smooth_path(cup_handle(), sides), HANDLE_RADIUS, sides // 3)])
    outline = {"glass": _glass_outline, "bowl": _bowl_outline, "plate": _plate_outline}
    draw = outline[category.split()[-1]]
    return turned(draw(width / 2, height / 2, sides), sides, 0.0, stretch)


def smooth_path(points: np.ndarray, count: int) -> np.ndarray:
    """A smooth line through points in a plane y = constant, (count, 3)."""
    line = smooth([(x, z) for x, _, z in points], count)
    return np.insert(line, 1, points[0, 1], axis=1)


def _cup_outline(points: int) -> np.ndarray:
    radius, half = CUP_RADIUS, EXTENTS["cup"][2] / 2
    outside = smooth(
        [(radius - 0.012, -half), (radius - 0.003, -half + 0.004), (radius, -half + 0.016),
         (radius, half - 0.003), (radius - 0.002, half)],
        points,
    )  # fmt: skip
    inside = smooth(
        [(radius - 0.004, half - 0.002), (radius - 0.005, -half + 0.02),
         (radius - 0.016, -half + 0.007)],
        points // 2,
    )  # fmt: skip
    return np.concatenate([[(0.0, -half)], outside, inside, [(0.0, -half + 0.007)]])


def _glass_outline(radius: float, half: float, points: int) -> np.ndarray:
    foot = 0.76 * radius
    outside = smooth(
        [(foot - 0.004, -half), (foot, -half + 0.004), (radius, half - 0.002),
         (radius - 0.001, half)],
        points,
    )  # fmt: skip
    inside = smooth([(radius - 0.004, half - 0.002), (foot - 0.005, -half + 0.012)], points // 2)
    return np.concatenate([[(0.0, -half)], outside, inside, [(0.0, -half + 0.009)]])


def _bowl_outline(radius: float, half: float, points: int) -> np.ndarray:
    foot, wall = 0.42 * radius, 0.005
    outside = smooth(
        [(foot, -half), (foot + 0.001, -half + 0.006), (0.66 * radius, -0.62 * half),
         (0.86 * radius, -0.12 * half), (0.97 * radius, 0.55 * half), (radius, half)],
        points,
    )  # fmt: skip
    inside = smooth(
        [(radius - wall, half - 0.001), (0.97 * radius - wall, 0.55 * half),
         (0.86 * radius - wall, -0.10 * half), (0.62 * radius, -0.58 * half),
         (0.25 * radius, -half + 0.013)],
        points,
    )  # fmt: skip
    below = [(0.0, -half + 0.003), (foot - 0.005, -half + 0.003), (foot - 0.004, -half)]
    return np.concatenate([below, outside, inside, [(0.0, -half + 0.012)]])


def _plate_outline(radius: float, half: float, points: int) -> np.ndarray:
    foot, wall = 0.60 * radius, 0.004
    outside = smooth(
        [(foot, -half), (foot + 0.002, -half + 0.003), (0.74 * radius, 0.0),
         (radius, half - 0.001)],
        points // 2,
    )  # fmt: skip
    inside = smooth(
        [(radius - 0.001, half), (0.74 * radius, wall), (0.66 * radius, -half + 1.7 * wall),
         (0.58 * radius, -half + 1.4 * wall)],
        points // 2,
    )  # fmt: skip
    below = [(0.0, -half + 0.002), (foot - 0.006, -half + 0.002), (foot - 0.005, -half)]
    return np.concatenate([below, outside, inside, [(0.0, -half + 1.4 * wall)]])


def _tray() -> Surface:
    x, y, z = (extent / 2 for extent in EXTENTS["tray"])
    wall = 0.011
    walls = (
        ((-x, -y, -z), (x, y, -z + wall)),
        ((-x, -y, -z + wall), (-x + wall, y, z)),
        ((x - wall, -y, -z + wall), (x, y, z)),
        ((-x + wall, -y, -z + wall), (x - wall, -y + wall, z)),
        ((-x + wall, y - wall, -z + wall), (x - wall, y, z)),
    )
    return joined(box_surface(low, high, TRAY_TEXTURE) for low, high in walls)

"""The dishes of a plan: in their category's colour, or, in the second tier, as what they are."""

import numpy as np

from kitchen_prefs.rendering.canvas import Canvas
from kitchen_prefs.rendering.dish_outlines import Outline, outline
from kitchen_prefs.rendering.palette import CLAY, GRAIN, STAIN, WOOD, colour_of
from kitchen_prefs.rendering.plan_ground import Area
from kitchen_prefs.rendering.state import Look

# The colours of the leaderboard's page.
GLAZES = {
    "cup": "#c8402f",
    "glass": "#a9d8d6",
    "tray": "#8a4b1f",
    "small bowl": "#2c6cb0",
    "big bowl": "#5b8a45",
    "small plate": "#93bfe6",
    "big plate": "#fbf7ea",
}
EDGE, MARK, INSIDE, SHADOW = "#2a2f2c", (42, 47, 44, 150), (0, 0, 0, 40), (60, 45, 20, 70)
SHADOW_OFFSET = np.array([1.5, 2.5])  # pixels
GRAIN_STEP = 0.016  # m between two lines of the grain
# Stains: their places from the middle to a corner of the outline, and their radius by its size.
STAINS = ((0.05, 0.30), (0.30, 0.65), (0.55, 0.45), (0.72, 0.70), (0.90, 0.55))
STAIN_RADIUS = 0.10


def draw_dish(
    canvas: Canvas, area: Area, category: str, pose: np.ndarray, look: Look | None
) -> None:
    """Draw a dish.

    Args:
        canvas: What is drawn on.
        area: The part of the kitchen that it stands in.
        category: Its category.
        pose: Where it is, (7,).
        look: What it is in the second tier; None in the first.
    """
    shape = outline(category, pose, look.scale if look else 1.0)
    if look is None or look.material != "glass":  # light goes through glass
        for part in shape.parts:
            canvas.polygon(area.place(part) + SHADOW_OFFSET, SHADOW)
    fill = rgba(*colour_of(look)) if look else GLAZES[category]
    for part in shape.parts:
        canvas.polygon(area.place(part), fill, EDGE)
    if look is not None:
        _draw_material(canvas, area, shape, look.material)
    canvas.polygon(area.place(shape.mark), INSIDE if shape.inside else None, MARK)
    if look is not None and look.greasy:
        _draw_stains(canvas, area.place(shape.parts[-1]))


def rgba(red: float, green: float, blue: float, alpha: float = 1.0) -> tuple[int, int, int, int]:
    """A colour of `palette`, 0 to 1, as a canvas takes it."""
    return (round(255 * red), round(255 * green), round(255 * blue), round(255 * alpha))


def _draw_material(canvas: Canvas, area: Area, shape: Outline, material: str) -> None:
    """A ceramic dish's rim of clay, or the wood within a painted rim."""
    if material == "ceramic":
        canvas.polygon(_towards_middle(area.place(shape.parts[-1]), 0.93), None, rgba(*CLAY), 2.5)
    elif material == "wood":
        bare = _towards_middle(shape.parts[-1], 0.72)
        canvas.polygon(area.place(bare), rgba(*WOOD))
        for line in _chords(bare, GRAIN_STEP):
            canvas.line(area.place(line), rgba(*GRAIN), 1)


def _draw_stains(canvas: Canvas, silhouette: np.ndarray) -> None:
    middle, size = silhouette.mean(axis=0), np.ptp(silhouette, axis=0).max()
    for turn, share in STAINS:
        corner = silhouette[int(turn * len(silhouette))]
        canvas.circle(middle + share * (corner - middle), STAIN_RADIUS * size, rgba(*STAIN))


def _towards_middle(points: np.ndarray, share: float) -> np.ndarray:
    """A polygon, (n, 2), so much smaller about its middle."""
    middle = points.mean(axis=0)
    return middle + share * (points - middle)


def _chords(polygon: np.ndarray, step: float) -> list[np.ndarray]:
    """Lines across a convex polygon, (n, 2), along its second axis, (2, 2) each."""
    start, end = polygon, np.roll(polygon, -1, axis=0)
    chords = []
    for x in np.arange(polygon[:, 0].min() + step / 2, polygon[:, 0].max(), step):
        crossed = (start[:, 0] < x) != (end[:, 0] < x)
        first, second = start[crossed], end[crossed]
        way = (x - first[:, 0]) / (second[:, 0] - first[:, 0])
        y = first[:, 1] + way * (second[:, 1] - first[:, 1])
        chords.append(np.column_stack([[x, x], y]))
    return chords

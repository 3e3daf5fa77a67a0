"""What stands beside a plan's racks: the user's order, or how the second tier's dishes look."""

import numpy as np

from kitchen_prefs.people.attributes import MATERIALS
from kitchen_prefs.preferences import Preference
from kitchen_prefs.rendering import plan_ground as ground
from kitchen_prefs.rendering.canvas import Canvas
from kitchen_prefs.rendering.plan_dishes import draw_dish
from kitchen_prefs.rendering.state import Look

TINT = "#fbdcc4"  # behind what a decision is about
SCALE = 90  # pixels a metre, of the dishes in the lists beside the racks
STEP = 36  # pixels from one to the next
UPRIGHT = np.array([0, 0, 0, 1, 0, 0, 0])
# What a legend of the second tier shows beside each rack: a name and a dish.
LEGEND = {
    "top": [
        (name, "tray" if name == "wood" else "small bowl", Look(name, "blue")) for name in MATERIALS
    ],
    "bottom": [
        ("clean", "small plate", Look("ceramic", "white")),
        ("greasy", "small plate", Look("ceramic", "white", greasy=True)),
        ("small", "cup", Look("plastic", "red", scale=0.85)),
        ("large", "cup", Look("plastic", "red", scale=1.15)),
    ],
}


def draw_order(canvas: Canvas, rack: str, preference: Preference, at_issue: str | None) -> None:
    """What the user wants in a rack, in order, beside it."""
    _, top, right, _ = ground.RACK_AREAS[rack].box
    nth = "first" if preference.first == rack else "second"
    canvas.text((right + 12, top + 6), f"load {nth}", 13, ground.SOFT, "lm")
    for place, category in enumerate(preference.order(rack)):
        y = top + 38 + STEP * place
        if category == at_issue:
            canvas.rectangle((right + 8, y - 15, right + 106, y + 15), TINT, radius=6)
        _draw_entry(canvas, (right, y), category, category, None)


def draw_legend(canvas: Canvas, rack: str) -> None:
    """What materials, stains and sizes look like, beside a rack."""
    _, top, right, _ = ground.RACK_AREAS[rack].box
    for place, (name, category, look) in enumerate(LEGEND[rack]):
        _draw_entry(canvas, (right, top + 38 + STEP * place), name, category, look)


def _draw_entry(
    canvas: Canvas, start: tuple[float, float], name: str, category: str, look: Look | None
) -> None:
    """A small dish and a name in a list beside a rack."""
    x, y = start
    swatch = ground.Area((0.0, 0.0), (0.0, 0.0), (x + 26, y), SCALE)
    draw_dish(canvas, swatch, category, UPRIGHT, look)
    canvas.text((x + 43, y), name, 12.5, ground.INK, "lm")

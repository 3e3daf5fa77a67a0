"""What a plan has besides dishes: its title, the counter with the sink, both racks, the door."""

from dataclasses import dataclass

import numpy as np

from kitchen_prefs.preferences import RACKS
from kitchen_prefs.rendering.canvas import Canvas
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.kitchen import rack_position

WIDTH, HEIGHT = 640, 480  # pixels, a camera's usual size
MARGIN = 14
COUNTER_TOP, RACKS_TOP, DOOR_TOP = 62, 228, 436
RACKS_LEFT = {"top": MARGIN, "bottom": 326}
RACK_SCALE = 360  # pixels a metre: twice the counter's
WIRES = 6  # of a rack, each way

# The colours of the leaderboard's page.
INK, SOFT, LINE, PAPER, CARD = "#22302a", "#57625b", "#ddd5c4", "#f5f0e6", "#fffdf8"
GREEN, SHADE = "#24513f", "#e9e3d5"
WOOD, WOOD_EDGE = "#dcbd94", "#b8956a"
STEEL, BASIN, TAP, EDGE = "#c3c9c7", "#aeb6b4", "#eef1f0", "#857d6c"


@dataclass(frozen=True)
class Area:
    """A part of the kitchen in the picture.

    Attributes:
        metres: Its left and its back edge in the kitchen.
        size: Along x and y, m.
        pixels: Its left and its top edge in the picture.
        scale: Pixels a metre.
    """

    metres: tuple[float, float]
    size: tuple[float, float]
    pixels: tuple[float, float]
    scale: float

    def place(self, points: np.ndarray) -> np.ndarray:
        """Where points of the kitchen, (n, 2) m, are in the picture, (n, 2)."""
        return (points - self.metres) * (self.scale, -self.scale) + self.pixels

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Its left, top, right and bottom in the picture."""
        (left, top), (width, depth) = self.pixels, self.size
        return (left, top, left + width * self.scale, top + depth * self.scale)

    @property
    def centre(self) -> np.ndarray:
        """Its middle in the picture, (2,)."""
        left, top, right, bottom = self.box
        return np.array([left + right, top + bottom]) / 2


def _rack_area(rack: str) -> Area:
    """A rack and its dishes as they stand when it is out."""
    x, y, _ = rack_position(rack, out=True)
    width, depth = layout.RACK_INNER
    return Area(
        (x - width / 2, y + depth / 2), (width, depth), (RACKS_LEFT[rack], RACKS_TOP), RACK_SCALE
    )


_LENGTH = layout.COUNTER_X[1] - layout.COUNTER_X[0]
COUNTER = Area(
    metres=(layout.COUNTER_X[0], layout.COUNTER_Y[1]),
    size=(_LENGTH, layout.COUNTER_Y[1] - layout.COUNTER_Y[0]),
    pixels=(MARGIN, COUNTER_TOP),
    scale=(WIDTH - 2 * MARGIN) / _LENGTH,
)
SINK = Area(
    metres=(
        layout.SINK_CENTRE[0] - layout.SINK_SIZE[0] / 2,
        layout.SINK_CENTRE[1] + layout.SINK_SIZE[1] / 2,
    ),
    size=layout.SINK_SIZE[:2],
    pixels=tuple(
        COUNTER.place(
            np.array(layout.SINK_CENTRE) + np.array(layout.SINK_SIZE[:2]) * (-0.5, 0.5)
        ).tolist()
    ),
    scale=COUNTER.scale,
)
RACK_AREAS = {rack: _rack_area(rack) for rack in RACKS}
DOOR_BOX = (MARGIN, DOOR_TOP, WIDTH - MARGIN, HEIGHT - MARGIN)


def draw_title(canvas: Canvas, words: str, number: int, count: int) -> None:
    """What the decision does, which one it is, and how far the episode is."""
    end = WIDTH - MARGIN
    canvas.text((MARGIN, 24), f"{words[0].upper()}{words[1:]}", 22, INK, "lm")
    canvas.text((end, 24), f"decision {number + 1} of {count}", 15, SOFT, "rm")
    canvas.rectangle((MARGIN, 44, end, 48), LINE)
    canvas.rectangle((MARGIN, 44, MARGIN + (end - MARGIN) * (number + 1) / count, 48), GREEN)


def draw_counter(canvas: Canvas, sunk: int) -> None:
    """The counter and the sink, with the number of dishes that lie in it."""
    canvas.rectangle(COUNTER.box, WOOD, WOOD_EDGE, thickness=1.5, radius=4)
    left, top, right, bottom = SINK.box
    canvas.rectangle(SINK.box, STEEL, EDGE, radius=9)
    canvas.rectangle((left + 4, top + 4, right - 4, bottom - 4), BASIN, radius=7)
    middle = (left + right) / 2
    canvas.line(np.array([(middle, top - 12), (middle, top + 14)]), EDGE, 6)
    canvas.line(np.array([(middle, top - 11), (middle, top + 13)]), TAP, 4)
    words = f"sink: {sunk} dish{'' if sunk == 1 else 'es'}" if sunk else "sink"
    canvas.text((middle, bottom - 14), words, 12, INK, "mm")


def draw_rack(canvas: Canvas, rack: str, out: bool) -> None:
    """A rack with its name: white with a green frame when it is out, grey when it is in."""
    left, top, right, bottom = box = RACK_AREAS[rack].box
    canvas.text((left, top - 15), f"{rack} rack", 16, GREEN if out else INK, "lm")
    canvas.text((right, top - 15), "out" if out else "in", 14, GREEN if out else SOFT, "rm")
    canvas.rectangle(box, CARD if out else SHADE, radius=6)
    for share in np.arange(1, WIRES) / WIRES:
        x, y = left + share * (right - left), top + share * (bottom - top)
        canvas.line(np.array([(x, top), (x, bottom)]), LINE, 1)
        canvas.line(np.array([(left, y), (right, y)]), LINE, 1)
    canvas.rectangle(box, None, GREEN if out else EDGE, 3 if out else 1.5, radius=6)


def draw_door(canvas: Canvas, is_open: bool) -> None:
    """The dishwasher's door, along the lower edge."""
    canvas.rectangle(DOOR_BOX, CARD if is_open else STEEL, GREEN if is_open else EDGE, 1.5, 5)
    left, top, right, bottom = DOOR_BOX
    words = "door: open" if is_open else "door: closed"
    canvas.text(((left + right) / 2, (top + bottom) / 2), words, 13, INK, "mm")

"""A canvas with smooth edges, on which the plan of the kitchen is drawn."""

from functools import cache

import numpy as np
from PIL import Image, ImageDraw, ImageFont

# Drawn this many times as large and then reduced, because pillow's shapes have no smooth edges.
SHARPNESS = 3

Colour = str | tuple[int, int, int, int]  # a name or hexadecimal, or RGBA


class Canvas:
    """Draws in pixels of the finished picture, (0, 0) at the top left.

    Args:
        width: Of the picture.
        height: Of the picture.
        colour: Of the ground.
    """

    def __init__(self, width: int, height: int, colour: Colour) -> None:
        self._image = Image.new("RGB", (width * SHARPNESS, height * SHARPNESS), colour)
        self._draw = ImageDraw.Draw(self._image, "RGBA")  # so that colours may be translucent

    def polygon(
        self,
        points: np.ndarray,
        fill: Colour | None,
        edge: Colour | None = None,
        thickness: float = 1.0,
    ) -> None:
        """A polygon of corners, (n, 2)."""
        corners = [tuple(corner) for corner in points * SHARPNESS]
        if fill is not None:
            self._draw.polygon(corners, fill)
        if edge is not None:
            self._line([*corners, corners[0], corners[1]], edge, thickness)

    def rectangle(
        self,
        box: tuple[float, float, float, float],
        fill: Colour | None,
        edge: Colour | None = None,
        thickness: float = 1.0,
        radius: float = 0.0,
    ) -> None:
        """A rectangle of left, top, right and bottom, with rounded corners."""
        self._draw.rounded_rectangle(
            [side * SHARPNESS for side in box],
            radius * SHARPNESS,
            fill,
            edge,
            round(thickness * SHARPNESS),
        )

    def circle(
        self,
        centre: np.ndarray,
        radius: float,
        fill: Colour | None,
        edge: Colour | None = None,
        thickness: float = 1.0,
    ) -> None:
        """A circle around a point, (2,)."""
        self._draw.circle(
            tuple(centre * SHARPNESS),
            radius * SHARPNESS,
            fill,
            edge,
            round(thickness * SHARPNESS),
        )

    def line(self, points: np.ndarray, colour: Colour, thickness: float) -> None:
        """A line through points, (n, 2)."""
        self._line([tuple(point) for point in points * SHARPNESS], colour, thickness)

    def text(
        self, place: tuple[float, float], words: str, size: float, colour: Colour, anchor: str
    ) -> None:
        """A line of text; `anchor` is pillow's: "lm" begins at the place, "mm" is around it."""
        x, y = place
        font = _font(size * SHARPNESS)
        self._draw.text((x * SHARPNESS, y * SHARPNESS), words, colour, font, anchor)

    def picture(self) -> np.ndarray:
        """What is drawn, (H, W, 3) uint8."""
        return np.asarray(self._image.reduce(SHARPNESS))

    def _line(self, points: list[tuple[float, ...]], colour: Colour, thickness: float) -> None:
        self._draw.line(points, colour, round(thickness * SHARPNESS), joint="curve")


@cache
def _font(size: float) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    return ImageFont.load_default(size)  # pillow's own: the same letters on every machine

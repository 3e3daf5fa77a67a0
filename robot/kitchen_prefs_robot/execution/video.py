"""The video of an episode: each frame above its caption, encoded as it comes."""

from fractions import Fraction
from pathlib import Path
from textwrap import fill

import av
import numpy as np
from PIL import Image, ImageDraw, ImageFont

FPS = 20  # twice as fast as it was
BAR = 58  # pixels of the caption's bar: three lines
CHARACTERS = 76  # of 11 pixels that fit beside one another
INK, PAPER = (250, 248, 243), (38, 46, 51)


class Video:
    """An MP4 that browsers show.

    Args:
        path: The file.
        width: Of the pictures, in pixels.
        height: Of the pictures, in pixels; the bar of the caption comes below.
    """

    def __init__(self, path: Path, width: int, height: int) -> None:
        self._container = av.open(str(path), "w")
        self._stream = self._container.add_stream("libx264", rate=Fraction(FPS))
        self._stream.width, self._stream.height = width, height + BAR
        self._stream.pix_fmt = "yuv420p"

    def add(self, picture: np.ndarray, preference: str, decision: str) -> None:
        """Add a frame.

        Args:
            picture: (H, W, 3) uint8.
            preference: The preference in words, two lines of the caption at most.
            decision: The caption's last line.
        """
        frame = av.VideoFrame.from_image(captioned(picture, preference, decision))
        self._container.mux(self._stream.encode(frame))

    def close(self) -> None:
        """Write what is left."""
        self._container.mux(self._stream.encode())
        self._container.close()


def captioned(picture: np.ndarray, preference: str, decision: str) -> Image.Image:
    """A picture, (H, W, 3) uint8, above a bar: the preference in words, and the decision."""
    height, width, _ = picture.shape
    page = Image.new("RGB", (width, height + BAR), PAPER)
    page.paste(Image.fromarray(picture))
    draw = ImageDraw.Draw(page)
    small, large = ImageFont.load_default(11), ImageFont.load_default(14)
    draw.multiline_text((8, height + 4), fill(preference, CHARACTERS), INK, small, spacing=1)
    draw.text((8, height + 36), decision, INK, large)
    return page

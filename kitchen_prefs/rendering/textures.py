"""Wood and tiles, drawn by a seeded generator: the kitchen needs no picture files.

Each takes a tenth of a second or two and is drawn once a process, however many renderers there are.
"""

from functools import cache

import numpy as np
from scipy.ndimage import gaussian_filter1d, zoom

from kitchen_prefs.rendering.palette import WOOD

SEED = 7  # of all textures; any other gives another piece of wood
SIZE = 1024  # pixels along each side; every count of rows and columns divides it


@cache
def oak_floor() -> np.ndarray:
    """Planks along x, each of its own tone, with joints, (SIZE, SIZE, 3) uint8."""
    return _planks((201, 166, 125), rows=16, tones=0.13, joints=0.45, seed=SEED)


@cache
def walnut() -> np.ndarray:
    """The staves of a worktop along x, (SIZE, SIZE, 3) uint8."""
    return _planks((168, 116, 76), rows=16, tones=0.10, joints=0.90, seed=SEED + 1)


@cache
def beech() -> np.ndarray:
    """One pale board without a joint, for trays to tint, (SIZE, SIZE, 3) uint8."""
    return _planks((232, 204, 170), rows=1, tones=0.0, joints=1.0, seed=SEED + 3)


@cache
def ash() -> np.ndarray:
    """One pale board with dark growth rings, for wooden dishes, (SIZE, SIZE, 3) uint8."""
    rings = _streaks(np.random.default_rng(SEED + 4), SIZE, 20.0)
    years = 12 * np.linspace(0, 1, SIZE, endpoint=False)[:, None] + 0.6 * rings
    red, green, blue = (round(255 * part) for part in WOOD)
    dark = np.maximum(np.sin(2 * np.pi * years), 0.0) ** 2
    return _painted(1.0 - 0.35 * dark, (red, green, blue))


@cache
def tiles() -> np.ndarray:
    """White metro tiles, twice as wide as high, in a running bond, (SIZE, SIZE, 3) uint8."""
    rows, columns, joint = 8, 4, 4
    rng = np.random.default_rng(SEED + 2)
    height, width = SIZE // rows, SIZE // columns
    image = np.empty((SIZE, SIZE))
    for row in range(rows):
        for column in range(columns):
            tile = np.full((height, width), 1.0 + rng.normal(0.0, 0.006))
            tile[: 2 * joint] *= 1.015  # light falls on the upper edge, shade on the lower
            tile[-2 * joint :] *= 0.97
            tile[:joint] = tile[:, :joint] = 0.84
            image[row * height : (row + 1) * height, column * width : (column + 1) * width] = tile
        if row % 2:
            band = slice(row * height, (row + 1) * height)
            image[band] = np.roll(image[band], width // 2, axis=1)
    return _painted(image, (236, 238, 233))


def _planks(
    colour: tuple[int, int, int], rows: int, tones: float, joints: float, seed: int
) -> np.ndarray:
    rng = np.random.default_rng(seed)
    height = SIZE // rows
    image = np.empty((SIZE, SIZE))
    for row in range(rows):
        grain, rings = (_streaks(rng, height, width) for width in (1.2, 9.0))
        plank = 1.0 + 0.022 * grain + 0.035 * np.sin(2.5 * rings)
        ends = np.sort((rng.uniform() + np.array([0.0, 0.5])) % 1.0 * SIZE).astype(int)
        plank[:, ends[0] : ends[1]] *= 1.0 + rng.uniform(-tones, tones)
        plank *= 1.0 + rng.uniform(-tones, tones) / 2
        plank[:, np.concatenate([ends, ends + 1]) % SIZE] *= joints
        plank[:2] *= joints
        image[row * height : (row + 1) * height] = plank
    return _painted(image, colour)


def _streaks(rng: np.random.Generator, height: int, width: float) -> np.ndarray:
    """Noise of unit variance, long in x and `width` pixels wide in y, (height, SIZE)."""
    coarse = gaussian_filter1d(rng.normal(size=(height, 16)), width, axis=0, mode="wrap")
    streaks = zoom(coarse, (1, SIZE // 16), order=3, mode="grid-wrap", grid_mode=True)
    return streaks / streaks.std()


def _painted(brightness: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    return np.clip(brightness[..., None] * colour, 0, 255).astype(np.uint8)

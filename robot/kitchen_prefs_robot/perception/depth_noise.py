"""What a stereo depth camera gets wrong: noise that grows with the distance, and edges.

The paper's camera is an Intel RealSense D435. It measures a disparity, whose error is a part of a
pixel, so error of the depth = depth² x subpixel / (focal length x baseline) (Intel, "Tuning depth
cameras for best performance"). At the edge of an object a stereo match covers what lies before and
what lies behind: such pixels have no depth, or one in between.
"""

import numpy as np

BASELINE = 0.050  # m between the two infrared cameras
FOCAL_LENGTH = 425.0  # pixels of the depth stream, 848 wide over 90 degrees
SUBPIXEL = 0.08  # pixels, standard deviation of the disparity: 3.8 mm of depth at one metre
EDGE = 0.02  # m between neighbouring pixels that belong to two surfaces
LOST, MIXED = 0.5, 0.25  # shares of the pixels at an edge: without depth, with one in between


def with_noise(depth: np.ndarray, rng: np.random.Generator, scale: float = 1.0) -> np.ndarray:
    """Measure a depth image as a stereo camera would.

    Args:
        depth: True depths along the optical axis, (H, W) m.
        rng: Draws the errors.
        scale: Multiplies the disparity's error; 0 leaves the depths as they are.

    Returns:
        Measured depths, (H, W) m, 0 where there is none.
    """
    if scale == 0:
        return depth.copy()
    measured = _with_mixed_edges(depth, rng)
    disparity = FOCAL_LENGTH * BASELINE / np.maximum(measured, 1e-3)  # (H, W) pixels
    disparity += scale * SUBPIXEL * rng.standard_normal(depth.shape)
    noisy = FOCAL_LENGTH * BASELINE / np.maximum(disparity, 1e-3)
    return np.where(measured > 0, noisy, 0.0)


def _with_mixed_edges(depth: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Drop or blend the pixels at edges."""
    near, far = _neighbourhood(depth)
    draw, weight = rng.random((2, *depth.shape))
    at_edge = far - near > EDGE
    blended = near + weight * (far - near)
    measured = np.where(at_edge & (draw < LOST + MIXED), blended, depth)
    return np.where(at_edge & (draw < LOST), 0.0, measured)


def _neighbourhood(depth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The nearest and the farthest depth among a pixel and its four neighbours, (H, W) m each."""
    padded = np.pad(depth, 1, mode="edge")
    around = np.stack(
        [depth, padded[:-2, 1:-1], padded[2:, 1:-1], padded[1:-1, :-2], padded[1:-1, 2:]]
    )
    return around.min(axis=0), around.max(axis=0)

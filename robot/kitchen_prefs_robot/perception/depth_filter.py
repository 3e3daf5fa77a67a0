"""Depth images made smoother while their edges stay, as the makers of depth cameras recommend."""

import numpy as np

WINDOW = 3  # pixels; a bowl's wall is two pixels thick at 320 x 240


def smoothed(depth: np.ndarray) -> np.ndarray:
    """The median depth round each pixel.

    Args:
        depth: (H, W) m, 0 where there is none.

    Returns:
        (H, W) m: the median of the window's measured depths where the pixel has one, else 0.
    """
    measured = np.where(depth > 0, depth, np.nan)
    padded = np.pad(measured, WINDOW // 2, constant_values=np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(padded, (WINDOW, WINDOW))
    ordered = np.sort(windows.reshape(*depth.shape, WINDOW**2), axis=-1)  # NaN comes last
    count = np.isfinite(ordered).sum(axis=-1)
    middle = np.maximum(count - 1, 0)[..., None] // 2
    median = np.take_along_axis(ordered, middle, axis=-1)[..., 0]
    return np.where(depth > 0, median, 0.0)

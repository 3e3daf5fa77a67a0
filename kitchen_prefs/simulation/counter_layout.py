"""Random upright poses of dishes on the counter, none overlapping."""

import numpy as np

from kitchen_prefs.simulation import layout

DISH_GAP = 0.01  # m between dishes on the counter: fingers fit in
COUNTER_MARGIN = 0.02  # m to the counter's edges and the sink's
POSE_DECIMALS = 4  # a tenth of a millimetre: no machine's last digit shows in the data
TRIES_PER_DISH = 200  # before the whole counter is laid anew


def lay_counter(extents: np.ndarray, generator: np.random.Generator) -> np.ndarray:
    """Draw upright poses on the counter, (n, 7), no two overlapping.

    Args:
        extents: The full extents of each dish, (n, 3) m; at most twenty fit for certain.
        generator: Draws the poses.
    """
    while True:
        poses = try_to_lay_counter(extents, generator)
        if poses is not None:
            return poses


def try_to_lay_counter(extents: np.ndarray, generator: np.random.Generator) -> np.ndarray | None:
    """The same, but None where a dish finds no room beside the others that were laid."""
    poses = np.zeros((len(extents), 7), dtype=np.float32)
    radius = np.hypot(extents[:, 0], extents[:, 1]) / 2 + DISH_GAP / 2
    laid: list[tuple[np.ndarray, np.ndarray, float]] = []  # corners, centre, radius
    for dish in np.argsort(-radius, kind="stable"):  # the largest first: they find room
        half = extents[dish, :2] / 2 + DISH_GAP / 2
        for _ in range(TRIES_PER_DISH):
            centre, yaw = _random_spot(half, generator)
            corners = _corners(centre, half, yaw)
            if not any(
                np.hypot(*(centre - other)) < radius[dish] + reach and _overlap(corners, outline)
                for outline, other, reach in laid
            ):
                break
        else:
            return None
        laid.append((corners, centre, radius[dish]))
        height = layout.COUNTER_HEIGHT + extents[dish, 2] / 2
        pose = (*centre, height, np.cos(yaw / 2), 0, 0, np.sin(yaw / 2))
        poses[dish] = np.round(pose, POSE_DECIMALS)
    return poses


def _random_spot(half: np.ndarray, generator: np.random.Generator) -> tuple[np.ndarray, float]:
    """A centre, (2,), and a yaw for a dish beside the sink, inside the counter's edges."""
    yaw = generator.uniform(-np.pi, np.pi)
    reach_x = abs(np.cos(yaw)) * half[0] + abs(np.sin(yaw)) * half[1] + COUNTER_MARGIN
    reach_y = abs(np.sin(yaw)) * half[0] + abs(np.cos(yaw)) * half[1] + COUNTER_MARGIN
    left, right = layout.COUNTER_X
    sink_left, sink_right = (layout.SINK_CENTRE[0] + s * layout.SINK_SIZE[0] / 2 for s in (-1, 1))
    room_left = sink_left - left - 2 * reach_x
    room_right = right - sink_right - 2 * reach_x
    x = generator.uniform(0, room_left + room_right)
    x += left + reach_x if x < room_left else sink_right + reach_x - room_left
    y = generator.uniform(layout.COUNTER_Y[0] + reach_y, layout.COUNTER_Y[1] - reach_y)
    return np.array([x, y]), yaw


def _corners(centre: np.ndarray, half: np.ndarray, yaw: float) -> np.ndarray:
    """The corners of a turned rectangle, (4, 2)."""
    across = half[0] * np.array([np.cos(yaw), np.sin(yaw)])
    along = half[1] * np.array([-np.sin(yaw), np.cos(yaw)])
    return centre + np.array([across + along, across - along, -across - along, along - across])


def _overlap(a: np.ndarray, b: np.ndarray) -> bool:
    """Whether two rectangles, (4, 2) each, overlap, by the separating axis theorem."""
    axes = np.array([a[0] - a[1], a[1] - a[2], b[0] - b[1], b[1] - b[2]])  # (4, 2)
    on_a, on_b = axes @ a.T, axes @ b.T  # (4, 4)
    return bool(((on_a.max(1) > on_b.min(1)) & (on_b.max(1) > on_a.min(1))).all())

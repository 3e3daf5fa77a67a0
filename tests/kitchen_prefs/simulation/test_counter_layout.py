"""Dishes lie on the counter without overlap, beside the sink and inside the edges."""

from itertools import permutations

import numpy as np
import pytest

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation import layout
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import SPLITS


class Rectangle:
    """A turned rectangle on the counter, judged by points less than a centimetre apart."""

    def __init__(self, centre, size, yaw):
        self.centre, self.half = np.asarray(centre, dtype=float), np.asarray(size) / 2
        self.turn = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]])
        grid = np.stack(np.meshgrid(*2 * [np.linspace(-1, 1, 61)]), axis=-1).reshape(-1, 2)
        self.points = self.centre + grid * self.half @ self.turn  # (3721, 2)

    def holds_any(self, points):
        return (np.abs((points - self.centre) @ self.turn.T) < self.half).all(axis=1).any()


@pytest.mark.parametrize("split", SPLITS)
def test_dishes_stand_apart_on_the_counter_and_beside_the_sink(split):
    for index in (0, 5, 59):
        session = make_session(split, index)
        things = [Rectangle(layout.SINK_CENTRE, layout.SINK_SIZE[:2], yaw=0)]
        for category, pose in zip(session.dishes.category, session.dishes.pose, strict=True):
            extents = layout.EXTENTS[CATEGORIES[category]]
            yaw = 2 * np.arctan2(pose[6], pose[3])
            things.append(Rectangle(pose[:2], extents[:2], yaw))
            assert pose[2] == pytest.approx(layout.COUNTER_HEIGHT + extents[2] / 2)
        points = np.concatenate([thing.points for thing in things])
        for axis, (low, high) in enumerate((layout.COUNTER_X, layout.COUNTER_Y)):
            assert low < points[:, axis].min()
            assert points[:, axis].max() < high
        for a, b in permutations(things, 2):
            assert not a.holds_any(b.points)


def test_rectangles_that_overlap_are_found():
    plate = Rectangle((0, 0), (0.2, 0.2), yaw=0.5)
    assert plate.holds_any(Rectangle((0.15, 0), (0.2, 0.1), yaw=0).points)
    assert not plate.holds_any(Rectangle((0.25, 0), (0.2, 0.1), yaw=0).points)

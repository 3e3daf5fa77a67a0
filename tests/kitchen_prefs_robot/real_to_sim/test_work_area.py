import numpy as np
import pytest

pytest.importorskip("fast_simplification", reason="needs the extra `robot`")

from kitchen_prefs.simulation import layout
from kitchen_prefs_robot.real_to_sim import measure_counter
from kitchen_prefs_robot.real_to_sim.work_area import (
    fit_work_area,
    kitchen_corners,
    table_corners,
)

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def test_scales_and_shifts_are_found():
    area = fit_work_area(SQUARE, SQUARE * (2.0, 3.0) + (0.5, -1.0))
    assert area.yaw == pytest.approx(0.0)
    assert area.scale == pytest.approx((2.0, 3.0))
    assert area.shift == pytest.approx((0.5, -1.0))
    assert area.residual == pytest.approx(0.0, abs=1e-9)
    assert area.to_kitchen(np.array([0.5, 0.5])) == pytest.approx((1.5, 0.5))


@pytest.mark.parametrize("yaw", [-2.5, -0.8, 0.3, np.pi / 4, 3.0])
def test_an_area_that_is_turned_is_turned_back(yaw):
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    area = fit_work_area(SQUARE @ turn.T, SQUARE * (2.0, 3.0))
    assert area.residual == pytest.approx(0.0, abs=1e-9)
    assert np.cos(area.yaw + yaw) == pytest.approx(1.0)


def test_exact_corners_fall_on_the_kitchens():
    fitted = measure_counter(noise=0.0)
    assert fitted.residual < 1e-6
    assert fitted.to_kitchen(table_corners()) == pytest.approx(kitchen_corners(), abs=1e-6)
    assert min(fitted.scale) > 0  # nothing is mirrored


def test_measured_corners_leave_a_residual_of_their_error_times_the_scale():
    residuals = [measure_counter(noise=0.003, seed=seed).residual for seed in range(30)]
    assert 0.005 < np.mean(residuals) < 0.015


def test_the_counters_corners_are_where_dishes_can_stand():
    x, y = kitchen_corners().T
    assert x.min() >= layout.SINK_CENTRE[0] + layout.SINK_SIZE[0] / 2
    assert x.max() <= layout.COUNTER_X[1]
    assert (y.min(), y.max()) == layout.COUNTER_Y

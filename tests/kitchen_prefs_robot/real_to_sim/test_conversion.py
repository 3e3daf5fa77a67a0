import numpy as np
import pytest

pytest.importorskip("fast_simplification", reason="needs the extra `robot`")

from kitchen_prefs.simulation import layout
from kitchen_prefs_robot.perception.cloud import Cloud
from kitchen_prefs_robot.perception.clusters import box_round
from kitchen_prefs_robot.perception.detection import Detection
from kitchen_prefs_robot.real_to_sim import measure_counter, to_drawers_state
from kitchen_prefs_robot.scene.layout import COUNTER_X, COUNTER_Y
from kitchen_prefs_robot.task.rows import UPRIGHT, drop_position

COUNTER = measure_counter(noise=0.0)
CLOSED = {"upper": 0.0, "lower": 0.001}


def seen(category, place="counter", middle=(0.45, -0.2, 0.05), size=(0.14, 0.13, 0.10)):
    points = np.array(middle) + np.array(size) * (
        np.stack(np.meshgrid(*[[-0.5, 0.0, 0.5]] * 3), axis=-1).reshape(-1, 3)
    )
    return Detection(category, place, Cloud(points, np.zeros_like(points)), box_round(points))


def test_a_dish_on_the_table_stands_on_the_counter():
    state = to_drawers_state([seen("cup")], CLOSED, COUNTER)
    (dish,) = state.dishes
    assert (dish.category, dish.drawer) == ("cup", None)
    assert dish.position[2] == pytest.approx(layout.COUNTER_HEIGHT + layout.EXTENTS["cup"][2] / 2)
    assert np.linalg.norm(dish.quaternion) == pytest.approx(1.0)
    assert (state.opened, state.in_hand) == (None, None)


def test_what_stands_high_on_a_stand_stands_on_the_counter_too():
    high = to_drawers_state([seen("small plate", middle=(0.4, -0.2, 0.23))], CLOSED, COUNTER)
    low = to_drawers_state([seen("small plate", middle=(0.4, -0.2, 0.01))], CLOSED, COUNTER)
    assert high == low


@pytest.mark.parametrize("x", COUNTER_X)
@pytest.mark.parametrize("y", COUNTER_Y)
def test_the_counters_corners_are_the_kitchens(x, y):
    (dish,) = to_drawers_state([seen("cup", middle=(x, y, 0.05))], CLOSED, COUNTER).dishes
    right = layout.COUNTER_X[1] if y == COUNTER_Y[0] else -0.49
    near = layout.COUNTER_Y[0] if x == COUNTER_X[0] else layout.COUNTER_Y[1]
    assert dish.position[:2] == pytest.approx((right, near), abs=1e-6)


def test_a_dish_in_a_drawer_has_the_drop_pose():
    state = to_drawers_state([seen("cup", "lower")], {"upper": 0.0, "lower": 0.3}, COUNTER)
    (dish,) = state.dishes
    assert (dish.position, dish.quaternion) == (drop_position("lower"), UPRIGHT)
    assert (dish.drawer, state.opened) == ("lower", "lower")


def test_a_dish_that_a_person_shows_is_in_hand():
    state = to_drawers_state([seen("cup"), seen("big bowl", "hand")], CLOSED, COUNTER)
    assert state.in_hand == "big bowl"
    assert [dish.category for dish in state.dishes] == ["cup"]


@pytest.mark.parametrize("category", ["cup", "small plate", "big plate", "tray"])
def test_without_a_colour_the_size_says_the_category(category):
    size = 0.97 * np.array(layout.EXTENTS[category])
    (dish,) = to_drawers_state([seen(None, size=size)], CLOSED, COUNTER).dishes
    assert dish.category == category

"""The rows that a policy of the kitchen reads."""

from dataclasses import replace

import numpy as np
import pytest

from kitchen_prefs.envs.observations import RACK_ROWS
from kitchen_prefs.instances import DECISION, IS_OBJECT, IS_PLACE, POSE, POSITION, choosable
from kitchen_prefs_robot.task.decisions import Place, Toggle, choices
from kitchen_prefs_robot.task.rows import chosen_decision, drop_position, observe, placed, prompt_of
from kitchen_prefs_robot.task.sessions import make_session
from lerobot_policy_kitchen_prefs.common.dish_locations import in_rack, in_top_rack, on_counter


@pytest.fixture
def start():
    return make_session("test", 1).start


def test_at_the_start_both_drawers_are_closed_racks_and_all_dishes_on_the_counter(start):
    rows = observe(start, 0)
    assert (rows[0] == RACK_ROWS["top"][0]).all()
    assert (rows[1] == RACK_ROWS["bottom"][0]).all()
    assert len(rows) == 2 + 4
    assert on_counter(rows[2:]).all()
    assert not rows[:, IS_PLACE].any()


def test_an_open_drawer_is_a_rack_that_is_out_and_its_dishes_are_in_it(start):
    dishes = (placed("cup", "lower"), *start.dishes[1:])
    rows = observe(replace(start, dishes=dishes, opened="lower"), 5)
    assert (rows[1, POSITION] == RACK_ROWS["bottom"][1][POSITION]).all()
    assert (rows[:, DECISION] == 5).all()
    assert in_rack(rows[2])
    assert not in_top_rack(rows[2])
    assert in_top_rack(
        observe(replace(start, dishes=(placed("cup", "upper"),), opened="upper"), 0)[2]
    )


def test_a_closed_drawer_hides_its_dishes(start):
    dishes = (placed("cup", "lower"), *start.dishes[1:])
    assert len(observe(replace(start, dishes=dishes, opened="upper"), 0)) == 2 + 3


def test_the_only_place_for_the_dish_in_hand_is_the_drop_pose_of_the_open_drawer(start):
    state = replace(start, dishes=start.dishes[1:], opened="upper", in_hand="tray")
    rows = observe(state, 3)
    places = np.flatnonzero(rows[:, IS_PLACE])
    assert places.tolist() == [len(rows) - 1]
    assert np.allclose(rows[-1, POSITION], drop_position("upper"))
    assert choosable(rows).tolist() == [False] * (len(rows) - 1) + [True]
    assert chosen_decision(state, rows, rows[-1, POSE]) == Place("upper")


def test_an_action_chooses_the_nearest_row(start):
    rows = observe(start, 0)
    for row, choice in zip(rows, choices(start), strict=True):
        nearby = row[POSE] + np.array([0.01, 0, 0, 0, 0, 0, 0])
        assert chosen_decision(start, rows, nearby) == choice
    assert choices(start)[:2] == (Toggle("upper"), Toggle("lower"))


def test_a_prompt_has_the_sets_below_each_other_and_marks_what_was_chosen(start):
    sets = [observe(start, 0), observe(replace(start, opened="lower"), 1)]
    prompt = prompt_of(sets, [1, 4])
    real = prompt[prompt[:, IS_OBJECT] > 0]
    assert real.shape == (12, 14)
    assert np.flatnonzero(real[:, -1]).tolist() == [1, 6 + 4]
    assert (real[:, DECISION] == [0] * 6 + [1] * 6).all()

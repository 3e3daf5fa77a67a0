"""What a person did is read from two looks."""

import numpy as np
import pytest

pytest.importorskip("fast_simplification", reason="needs the extra `robot`")

from kitchen_prefs_robot.demonstrations.decisions import decision_between
from kitchen_prefs_robot.demonstrations.preferences import HUMAN_PREFERENCES, human_preference
from kitchen_prefs_robot.perception.cloud import Cloud
from kitchen_prefs_robot.perception.clusters import box_round
from kitchen_prefs_robot.perception.detection import Detection, Sight
from kitchen_prefs_robot.task.decisions import Pick, Place, Toggle


def dish(x, place="counter", category="cup"):
    points = np.array([(x, 0.0, 0.0), (x + 0.1, 0.1, 0.1)])
    return Detection(category, place, Cloud(points, np.zeros((2, 3))), box_round(points))


def look(*dishes, upper=0.0, lower=0.0):
    return Sight(dishes, {"upper": upper, "lower": lower}, (), np.zeros((0, 3)))


def test_a_drawer_opens_or_closes():
    assert decision_between(look(dish(0)), look(dish(0), lower=0.3)) == Toggle("lower")
    assert decision_between(look(dish(0), upper=0.29), look(dish(0))) == Toggle("upper")


def test_a_dish_is_picked_where_it_vanished_whatever_it_is_taken_for():
    before = look(dish(9, "upper"), dish(0), dish(1), dish(2), upper=0.3)
    after = look(dish(0.01), dish(2.01), dish(5, "hand", "big bowl"), upper=0.3)
    assert decision_between(before, after) == Pick(2)


def test_a_dish_is_placed_where_a_drawer_is_open():
    before, after = look(dish(0), dish(5, "hand"), lower=0.3), look(dish(0), lower=0.3)
    assert decision_between(before, after) == Place("lower")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (look(dish(0)), look(dish(0))),
        (look(dish(0), upper=0.3), look(dish(0), lower=0.3)),
        (look(dish(0)), look(dish(5, "hand"), lower=0.3)),
        (look(dish(5, "hand")), look(dish(0))),
    ],
)
def test_what_is_no_single_decision_is_refused(before, after):
    with pytest.raises(ValueError, match="one decision changes"):
        decision_between(before, after)


def test_a_dish_in_hand_that_left_no_gap_is_refused():
    with pytest.raises(ValueError, match="none has left the table"):
        decision_between(look(dish(0)), look(dish(0), dish(5, "hand")))


def test_four_preferences_differ_in_order_and_partition():
    assert len({(p.first, p.upper, p.lower) for p in HUMAN_PREFERENCES}) == 4
    assert {frozenset(p.categories) for p in HUMAN_PREFERENCES} == {
        frozenset(("small bowl", "big bowl", "cup", "small plate"))
    }


def test_a_preference_that_there_is_not_is_named():
    with pytest.raises(ValueError, match="no preference 7"):
        human_preference(7)

"""The paper's success, PE and ED on episodes whose values are known."""

import pytest

from kitchen_prefs.metrics import edit_similarity, packing_efficiency, success
from kitchen_prefs_robot.task.decisions import Pick, Place, Toggle
from kitchen_prefs_robot.task.expert import choose
from kitchen_prefs_robot.task.metrics import episode_of, right_dishes, right_drawer
from kitchen_prefs_robot.task.preferences import DrawerPreference
from kitchen_prefs_robot.task.sessions import make_session
from kitchen_prefs_robot.task.simulator import DrawersSimulator

SESSION = next(
    session
    for session in (make_session("test", index) for index in range(100))
    if (len(session.preference.upper), len(session.preference.lower)) == (2, 2)
)


def load(preference):
    """The episode of an expert with a preference of its own in the session."""
    simulator = DrawersSimulator(SESSION)
    while not (simulator.terminated or simulator.truncated):
        simulator.decide(choose(simulator.state, preference))
    return episode_of(simulator)


def test_the_session_s_own_preference_is_all_right():
    episode = load(SESSION.preference)
    assert right_dishes(episode) == right_drawer(episode) == packing_efficiency(episode) == 1
    assert edit_similarity(episode) == 1
    assert success(episode)


def test_the_other_order_of_the_drawers_is_right_in_place_and_half_in_order():
    upper, lower = SESSION.preference.upper, SESSION.preference.lower
    first = "upper" if SESSION.preference.first == "lower" else "lower"
    episode = load(DrawerPreference(first, upper, lower))
    assert right_drawer(episode) == packing_efficiency(episode) == 1
    assert right_dishes(episode) == 0.5
    assert success(episode)


def test_one_turn_out_of_order_costs_one_dish():
    p = SESSION.preference
    episode = load(DrawerPreference(p.first, p.upper[::-1], p.lower))
    assert right_drawer(episode) == 1
    assert right_dishes(episode) == 0.75


def test_the_opposite_preference_is_all_wrong():
    episode = load(SESSION.preference.opposite())
    assert right_dishes(episode) == right_drawer(episode) == packing_efficiency(episode) == 0
    assert episode.wrong_rack == 4
    assert not success(episode)


def test_refused_decisions_and_an_episode_that_never_ends():
    simulator = DrawersSimulator(SESSION)
    first = SESSION.preference.first
    other = "upper" if first == "lower" else "lower"
    dish = next(
        i
        for i, dish in enumerate(SESSION.start.dishes)
        if dish.category == SESSION.preference.order(first)[0]
    )
    for decision in (Pick(dish), Toggle(first), Pick(dish), Place(first)):
        simulator.decide(decision)
    while not simulator.truncated:
        simulator.decide(Toggle(other))
    episode = episode_of(simulator)
    assert len(episode.decisions) == simulator.limit == 24
    assert sum(episode.refused) == 21
    assert episode.longest_loop == 20
    assert right_dishes(episode) == right_drawer(episode) == 0.25
    assert packing_efficiency(episode) == pytest.approx(0.25)
    assert edit_similarity(episode) < 0

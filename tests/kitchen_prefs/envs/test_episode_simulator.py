"""Hand-worked examples of the metrics, played in the environment decision by decision.

The session is static: all dishes stand there at the start, so what is done early or late changes
nothing of what there is to do; and the expert drops nothing in the sink.
"""

from itertools import combinations

import pytest

from kitchen_prefs import instances
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.metrics import (
    METRICS,
    category_edit_similarity,
    edit_similarity,
    failure_modes,
    packing_efficiency,
    score,
    success,
    temporal_efficiency,
)
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation.kitchen import (
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    RACK_INSTANCE,
    SINK,
    Kitchen,
)
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs.splits import SPLITS


def static_session(split, sunk):
    """The first session with all dishes at the start of which the expert sinks some, or none."""
    return next(
        session
        for session in (make_session(split, index) for index in range(SPLITS[split].sessions))
        if session.dishes.present == len(session.dishes.category)
        and (SINK in expert_trajectory(session).decisions) == sunk
    )


SESSION = static_session("seen", sunk=False)
FIRST, SECOND = SESSION.preference.racks
EXPERT = expert_trajectory(SESSION).decisions
CLOSES = EXPERT.index(RACK_INSTANCE[FIRST], 2)
# The expert opens the door, fills one rack, fills the other, closes the door.
FILL_FIRST, FILL_SECOND = EXPERT[1 : CLOSES + 1], EXPERT[CLOSES + 1 : -1]
TOGGLE_FIRST = RACK_INSTANCE[FIRST]


def play(decisions, session=SESSION):
    """The episode of some decisions, each given as the pose of the instance that it chooses."""
    env = DishwasherLoading(session.split)
    observation, _ = env.reset(options={"session": session.index})
    for instance in decisions:
        rows = instances.unpad(observation["instances"])
        poses = rows[instances.choosable(rows), instances.POSE]
        action = next(pose for pose in poses if env.simulator.choose(pose)[0] == instance)
        observation, *_, info = env.step(action)
    assert env.episode().decisions == tuple(decisions)
    assert info["is_success"] == success(env.episode())
    return env.episode()


def dishes_for(rack):
    """The dishes that the preference gives a rack."""
    categories = SESSION.dishes.category.tolist()
    return [
        dish
        for dish, category in enumerate(categories)
        if SESSION.preference.rack_of[CATEGORIES[category]] == rack
    ]


def free_place(decisions, dish, rack):
    """The first placement of a rack that is free for a dish after some decisions."""
    kitchen = Kitchen(SESSION.dishes)
    for decision in decisions:
        assert kitchen.decide(decision) == ""
    free = kitchen.free(rack, int(SESSION.dishes.category[dish]))
    return FIRST_PLACEMENT[rack] + int(free[0])


def without_dish(decisions, dish):
    """The decisions without the pick of a dish and the place that follows it."""
    pick = decisions.index(FIRST_DISH + dish)
    return decisions[:pick] + decisions[pick + 2 :]


def test_the_experts_own_decisions_are_perfect():
    episode = play(EXPERT)
    assert {name: metric(episode) for name, metric in METRICS.items()} == dict.fromkeys(METRICS, 1)
    assert not any(failure_modes(episode).values())


def test_a_swapped_rack_order_keeps_packing_and_lowers_order():
    episode = play((DOOR, *FILL_SECOND, *FILL_FIRST, DOOR))
    # The shorter block is taken out where it stood and put in where it now stands.
    edits = 2 * min(len(FILL_FIRST), len(FILL_SECOND))
    assert packing_efficiency(episode) == temporal_efficiency(episode) == 1
    assert edit_similarity(episode) == pytest.approx(1 - edits / len(EXPERT))
    assert edit_similarity(episode) <= category_edit_similarity(episode) < 1
    assert score(episode) == (1 + category_edit_similarity(episode)) / 2
    assert success(episode)
    assert not any(failure_modes(episode).values())


def test_one_dish_in_the_wrong_rack_lowers_packing():
    dish, n = dishes_for(SECOND)[0], len(dishes_for(SECOND))
    filled = (DOOR, *FILL_FIRST[:-1])
    wrong = (FIRST_DISH + dish, free_place(filled, dish, FIRST))
    rest = without_dish(FILL_SECOND, dish)
    episode = play((*filled, *wrong, TOGGLE_FIRST, *rest, DOOR))
    assert packing_efficiency(episode) == pytest.approx((1 + (n - 1) / n) / 2)
    assert failure_modes(episode)["wrong rack"] == episode.wrong_rack == 1
    assert episode.finished
    assert not success(episode)


def test_all_dishes_in_wrong_racks_pack_nothing():
    decisions = (DOOR,)
    for rack, other in zip(RACKS, reversed(RACKS), strict=True):
        decisions += (RACK_INSTANCE[rack],)
        for dish in dishes_for(other):
            decisions += (FIRST_DISH + dish, free_place(decisions, dish, rack))
        decisions += (RACK_INSTANCE[rack],)
    episode = play((*decisions, DOOR))
    assert packing_efficiency(episode) == temporal_efficiency(episode) == 0
    assert episode.wrong_rack == len(SESSION.dishes.category)
    assert episode.finished
    assert not success(episode)


def test_moving_a_rack_to_and_fro_lowers_temporal_efficiency():
    moves = (TOGGLE_FIRST,) * 10
    episode = play((DOOR, *moves, *EXPERT[1:]))
    assert packing_efficiency(episode) == 1
    assert temporal_efficiency(episode) == pytest.approx(len(EXPERT) / (len(EXPERT) + 10))
    assert edit_similarity(episode) == pytest.approx(1 - 10 / len(EXPERT))
    assert success(episode)


def test_closing_the_door_before_the_counter_is_clear_counts():
    episode = play((DOOR, DOOR, *EXPERT))
    assert failure_modes(episode)["closed early"] == episode.closed_early == 1
    assert packing_efficiency(episode) == 1
    assert edit_similarity(episode) == pytest.approx(1 - 2 / len(EXPERT))


def test_a_blocked_placement_counts():
    category = SESSION.dishes.category
    # Six dishes of four categories or less: two are alike.
    dish, like = next(
        (a, b) for a, b in combinations(dishes_for(FIRST), 2) if category[a] == category[b]
    )
    opened = (DOOR, TOGGLE_FIRST)
    place = free_place(opened, dish, FIRST)
    episode = play((*opened, FIRST_DISH + dish, place, FIRST_DISH + like, place, place))
    assert episode.refused == (False,) * 5 + (True, True)
    assert failure_modes(episode)["blocked place"] == episode.blocked_places == 2
    assert episode.longest_loop == 2
    assert sum(episode.placed) == 1


def test_sinking_without_need_counts_and_lowers_packing():
    dish, n = dishes_for(FIRST)[0], len(dishes_for(FIRST))
    rest = without_dish(EXPERT, dish)
    episode = play((FIRST_DISH + dish, SINK, *rest))
    assert failure_modes(episode)["sunk without need"] == episode.sunk == 1
    assert packing_efficiency(episode) == pytest.approx((1 + (n - 1) / n) / 2)
    assert episode.finished


def test_leaving_on_the_counter_what_the_expert_sinks_is_no_success():
    session = static_session("unseen_counts", sunk=True)
    decisions = expert_trajectory(session).decisions
    while SINK in decisions:
        place = decisions.index(SINK)
        decisions = decisions[: place - 1] + decisions[place + 1 :]
    episode = play(decisions, session)
    assert packing_efficiency(episode) == 1
    assert episode.closed
    assert not episode.finished
    assert not success(episode)
    assert failure_modes(episode)["closed early"] == 1


# Turn: of the moments when dishes of several ranks waited for the open rack ----------------------


def picks_of(decisions):
    """Where in some decisions dishes are picked."""
    return [i for i, instance in enumerate(decisions) if FIRST_DISH <= instance < SINK]


def test_the_expert_always_takes_the_dish_whose_turn_it_is():
    right, turns = play(EXPERT).turns
    assert right == turns
    # All but the dishes of the last category of each rack are picked while another one waits.
    last = {SESSION.preference.order(rack)[-1] for rack in RACKS}
    others = [dish for rack in RACKS for dish in dishes_for(rack) if category_of(dish) not in last]
    assert turns == len(others)


def category_of(dish):
    return CATEGORIES[SESSION.dishes.category[dish]]


def test_the_last_category_first_is_a_wrong_turn_and_a_refused_decision_is_none():
    rack = FIRST
    last = next(d for d in dishes_for(rack) if category_of(d) == SESSION.preference.order(rack)[-1])
    start = [DOOR, RACK_INSTANCE[rack]]
    assert play([*start, FIRST_DISH + last]).turns == (0, 1)
    assert play([*start, DOOR]).turns == (0, 0)  # refused: the door moves with both racks in
    assert play([*start, RACK_INSTANCE[rack]]).turns == (0, 1)  # closes while dishes wait
    assert play(EXPERT[:3]).turns == (1, 1)

"""The expert loads by the preference, and finishes from any reachable state."""

import numpy as np
import pytest

from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation.expert import roll_out_expert
from kitchen_prefs.simulation.kitchen import (
    BOTTOM_RACK,
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    IN_RACK,
    RACK_INSTANCE,
    SINK,
    TOP_RACK,
    Kitchen,
    Location,
)
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session


def preferred_rack(session, dish):
    return session.preference.rack_of[CATEGORIES[session.dishes.category[dish]]]


def feasible_decision(kitchen, session, generator):
    """A random decision that the kitchen carries out; a third of the racked dishes go wrong."""
    if kitchen.held is not None:
        return random_place(kitchen, generator)
    if kitchen.open_rack is None:
        return random_without_a_rack(kitchen, generator)
    wrong = generator.random() < 1 / 3
    dishes = [
        dish
        for dish in kitchen.counter.tolist()
        if (preferred_rack(session, dish) != kitchen.open_rack) == wrong
    ]
    if not dishes or generator.random() < 0.1:
        return RACK_INSTANCE[kitchen.open_rack]
    return FIRST_DISH + int(generator.choice(dishes))


def random_without_a_rack(kitchen, generator):
    """Mostly open the door and a rack; now and then close the door or pick what must be sunk."""
    if generator.random() < 0.1:
        return int(generator.choice([DOOR, *(FIRST_DISH + kitchen.counter)]))
    if not kitchen.door_open:
        return DOOR
    return int(generator.choice([BOTTOM_RACK, TOP_RACK]))


def random_place(kitchen, generator):
    """A free placement, or now and then the sink."""
    if kitchen.open_rack is None or generator.random() < 0.1:
        return SINK
    free = kitchen.free(kitchen.open_rack, int(kitchen.dishes.category[kitchen.held]))
    if len(free) == 0:
        return SINK
    return FIRST_PLACEMENT[kitchen.open_rack] + int(generator.choice(free))


@pytest.mark.parametrize("split", ["seen", "unseen_both", "many_preferences"])
@pytest.mark.parametrize("count", [1, 5, 20, 40])
def test_it_finishes_from_any_reachable_state(split, count):
    in_wrong_rack = []  # of every dish that the random decisions racked
    for index in range(60):
        session = make_session(split, index)
        generator = np.random.default_rng([index, count])
        kitchen = Kitchen(session.dishes)
        for _ in range(count):
            if kitchen.finished:
                break
            assert kitchen.decide(feasible_decision(kitchen, session, generator)) == ""
        for rack in RACKS:
            racked = np.flatnonzero(kitchen.location == IN_RACK[rack])
            in_wrong_rack += [preferred_rack(session, dish) != rack for dish in racked]
        run = roll_out_expert(kitchen, session.preference)
        assert run.kitchen.finished
        assert not (run.kitchen.location == Location.COUNTER).any()
    if count >= 20:
        assert len(in_wrong_rack) > 3 * 60
        assert 0.25 < np.mean(in_wrong_rack) < 0.42


@pytest.mark.parametrize("index", range(0, 70, 7))
def test_it_loads_racks_and_categories_in_the_preferred_order(index):
    session = next(
        session
        for session in (make_session("seen", i) for i in range(index, 70))
        if session.dishes.present >= 6
    )
    run = expert_trajectory(session)
    preference = session.preference
    assert run.kinds[:2] == ("door", f"{preference.first} rack")
    close = run.kinds.index(f"{preference.first} rack", 2)
    picked = [kind for kind in run.kinds[2:close] if kind in CATEGORIES]
    ranks = [preference.rank_of[category] for category in picked]
    assert ranks == sorted(ranks)
    assert {preference.rack_of[category] for category in picked} == {preference.first}


def test_it_puts_nothing_into_a_wrong_rack():
    for index in range(0, 150, 10):
        session = make_session("unseen_both", index)
        for category, place in zip(
            session.dishes.category, expert_trajectory(session).kitchen.location, strict=True
        ):
            rack = session.preference.rack_of[CATEGORIES[category]]
            assert place in (IN_RACK[rack], Location.SINK)


def test_it_uses_the_sink_only_when_nothing_fits():
    for index in range(0, 210, 5):
        session = make_session("unseen_counts", index)
        kitchen = expert_trajectory(session).kitchen
        for dish in np.flatnonzero(kitchen.location == Location.SINK):
            category = int(kitchen.dishes.category[dish])
            rack = session.preference.rack_of[CATEGORIES[category]]
            assert len(kitchen.free(rack, category)) == 0

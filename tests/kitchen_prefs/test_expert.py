"""The expert loads by the preference, and finishes from any reachable state."""

import numpy as np
import pytest

from kitchen_prefs import kitchen as k
from kitchen_prefs.expert import run_expert
from kitchen_prefs.kitchen import Kitchen, Place
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.sessions import expert_run, make_session


def feasible_decision(kitchen, preference, generator):
    """A random decision that the kitchen carries out; a third of the placed dishes go wrong."""
    if kitchen.held is None:
        objects = [k.DOOR] if kitchen.out is None else []
        if kitchen.door_open:
            objects += [k.RACK_INSTANCE[rack] for rack in RACKS if kitchen.out in (None, rack)]
        objects += [k.FIRST_DISH + int(dish) for dish in kitchen.counter] * 2
        return int(generator.choice(objects))
    if kitchen.out is None:
        return k.SINK
    category = int(kitchen.dishes.category[kitchen.held])
    wrong = preference.rack_of[CATEGORIES[category]] != kitchen.out
    free = kitchen.free(kitchen.out, category)
    if len(free) == 0 or (wrong and generator.random() > 0.5):
        return k.SINK
    return k.FIRST_PLACEMENT[kitchen.out] + int(generator.choice(free))


@pytest.mark.parametrize("split", ["seen", "unseen_both", "many_preferences"])
@pytest.mark.parametrize("count", [1, 5, 20, 40])
def test_it_finishes_from_any_reachable_state(split, count):
    wrong = 0
    for index in range(40):
        session = make_session(split, index)
        generator = np.random.default_rng([index, count])
        kitchen = Kitchen(session.dishes)
        for _ in range(count):
            if kitchen.finished:
                break
            assert kitchen.decide(feasible_decision(kitchen, session.preference, generator)) == ""
        wrong += sum(
            session.preference.rack_of[CATEGORIES[kitchen.dishes.category[dish]]] != rack
            for rack in RACKS
            for dish in np.flatnonzero(kitchen.place == k.IN_RACK[rack])
        )
        run = run_expert(kitchen, session.preference)
        assert run.kitchen.finished
        assert not (run.kitchen.place == Place.COUNTER).any()
    assert wrong > 0 or count < 20


@pytest.mark.parametrize("index", range(0, 70, 7))
def test_it_loads_racks_and_categories_in_the_preferred_order(index):
    session = next(
        session
        for session in (make_session("seen", i) for i in range(index, 70))
        if session.dishes.present >= 6
    )
    run = expert_run(session)
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
            session.dishes.category, expert_run(session).kitchen.place, strict=True
        ):
            rack = session.preference.rack_of[CATEGORIES[category]]
            assert place in (k.IN_RACK[rack], Place.SINK)


def test_it_uses_the_sink_only_when_nothing_fits():
    for index in range(0, 210, 5):
        session = make_session("unseen_counts", index)
        kitchen = expert_run(session).kitchen
        for dish in np.flatnonzero(kitchen.place == Place.SINK):
            category = int(kitchen.dishes.category[dish])
            rack = session.preference.rack_of[CATEGORIES[category]]
            assert len(kitchen.free(rack, category)) == 0

"""The rules of the kitchen, under the expert's, random and arbitrary decisions."""

import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs import kitchen as k
from kitchen_prefs.kitchen import Kitchen, Place, placement_table
from kitchen_prefs.sessions import make_session

CHOICES = st.one_of(
    st.sampled_from([k.DOOR, k.BOTTOM_RACK, k.TOP_RACK, k.SINK]),
    st.integers(k.FIRST_DISH, k.FIRST_DISH + 20),
    st.integers(0, 400).map(lambda placement: k.FIRST_PLACEMENT["bottom"] + placement),
    st.integers(0, 400).map(lambda placement: k.FIRST_PLACEMENT["top"] + placement),
)
SESSIONS = st.tuples(st.sampled_from(["seen", "unseen_both"]), st.integers(0, 69))


def new_kitchen(split="seen", index=0):
    return Kitchen(make_session(split, index).dishes)


def state(kitchen):
    return kitchen.digest()


@settings(max_examples=60, deadline=None)
@given(SESSIONS, st.lists(CHOICES, max_size=60))
def test_arbitrary_decisions_keep_the_rules(session, decisions):
    kitchen = new_kitchen(*session)
    blocks = placement_table().blocks
    for decision in decisions:
        before, places = state(kitchen), kitchen.place.copy()
        refusal = kitchen.decide(decision)
        assert bool(refusal) == (state(kitchen) == before)  # refused: nothing changed
        for rack, where in k.IN_RACK.items():
            standing = kitchen.placement[kitchen.place == where]
            between = blocks[np.ix_(standing, standing)]
            assert between.sum() == len(standing), f"dishes in the {rack} rack block each other"
        left = (places > Place.COUNTER) & (kitchen.place != places)
        assert not left.any(), "a dish that was put away moved"
        assert (kitchen.place >= Place.COUNTER).sum() >= (places >= Place.COUNTER).sum()
        assert kitchen.door_open or kitchen.out is None
        visible = kitchen.place[kitchen.visible_dishes()]
        hidden = {Place.SINK, Place.TO_COME} | (
            set(k.IN_RACK.values()) - {k.IN_RACK.get(kitchen.out)}
        )
        assert not set(visible.tolist()) & {int(place) for place in hidden}


def test_a_newly_opened_kitchen():
    kitchen = new_kitchen()
    assert kitchen.closed
    assert not kitchen.finished
    assert len(kitchen.visible_dishes()) == kitchen.dishes.present


def test_the_door_moves_only_with_both_racks_in():
    kitchen = new_kitchen()
    assert kitchen.decide(k.DOOR) == ""
    assert kitchen.decide(k.TOP_RACK) == ""
    assert "both racks in" in kitchen.decide(k.DOOR)
    assert kitchen.decide(k.TOP_RACK) == ""
    assert kitchen.decide(k.DOOR) == ""
    assert kitchen.closed


def test_a_rack_moves_only_with_the_door_open_and_the_other_in():
    kitchen = new_kitchen()
    assert "door open" in kitchen.decide(k.BOTTOM_RACK)
    kitchen.decide(k.DOOR)
    kitchen.decide(k.TOP_RACK)
    assert "other rack in" in kitchen.decide(k.BOTTOM_RACK)


def test_a_dish_goes_only_into_a_free_placement_of_the_open_rack():
    kitchen = new_kitchen()
    kitchen.decide(k.DOOR)
    kitchen.decide(k.TOP_RACK)
    dish = int(kitchen.counter[0])
    kitchen.decide(k.FIRST_DISH + dish)
    placement = int(kitchen.free("top", int(kitchen.dishes.category[dish]))[0])
    assert "rack that is out" in kitchen.decide(k.FIRST_PLACEMENT["bottom"] + placement)
    assert kitchen.decide(k.FIRST_PLACEMENT["top"] + placement) == ""
    assert "Only a dish on the counter" in kitchen.decide(k.FIRST_DISH + dish)
    same = [
        d for d in kitchen.counter if kitchen.dishes.category[d] == kitchen.dishes.category[dish]
    ]
    if same:
        kitchen.decide(k.FIRST_DISH + int(same[0]))
        assert "blocked" in kitchen.decide(k.FIRST_PLACEMENT["top"] + placement)


def test_a_sunk_dish_leaves_the_set():
    kitchen = new_kitchen()
    dish = int(kitchen.counter[0])
    kitchen.decide(k.FIRST_DISH + dish)
    assert kitchen.decide(k.SINK) == ""
    assert dish not in kitchen.visible_dishes()


def test_dishes_to_come_arrive_once_the_counter_is_cleared():
    kitchen = next(
        kitchen for kitchen in (new_kitchen(index=i) for i in range(70)) if not kitchen.all_arrived
    )
    for dish in kitchen.counter:
        assert not kitchen.finished
        kitchen.decide(k.FIRST_DISH + int(dish))
        kitchen.decide(k.SINK)
    assert len(kitchen.counter) == 1


def test_dishes_arrive_in_the_end_even_if_the_counter_is_never_cleared():
    kitchen = next(
        kitchen for kitchen in (new_kitchen(index=i) for i in range(70)) if not kitchen.all_arrived
    )
    for _ in range(k.ARRIVALS_AT_LATEST + len(kitchen.place)):
        kitchen.decide(k.DOOR)
    assert kitchen.all_arrived


@pytest.mark.parametrize("index", [0, 33])
def test_the_same_decisions_give_the_same_state_in_another_process(index):
    decisions = [k.DOOR, k.TOP_RACK, k.FIRST_DISH, k.SINK, k.FIRST_DISH + 1, k.SINK, k.TOP_RACK]
    kitchen = new_kitchen("unseen_both", index)
    for decision in decisions:
        kitchen.decide(decision)
    script = (
        "from kitchen_prefs.kitchen import Kitchen\n"
        "from kitchen_prefs.sessions import make_session\n"
        f"kitchen = Kitchen(make_session('unseen_both', {index}).dishes)\n"
        f"for decision in {decisions}: kitchen.decide(decision)\n"
        "print(kitchen.digest())"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == kitchen.digest()

"""The rules of the kitchen, under decisions that mostly may be chosen and some that never may."""

import json
import subprocess
import sys

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.kitchen import (
    ARRIVALS_AT_LATEST,
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
    placement_table,
)
from kitchen_prefs.simulation.sessions import make_session

JOINTS = (DOOR, BOTTOM_RACK, TOP_RACK)
# Now and then something that is seldom to be had: no dish, one that is put away or still to come, a
# placement of another rack or category, the sink with nothing in hand.
ANYTHING = (*range(-1, 24), SINK, *range(1000, 1400, 29), *range(2000, 2400, 29))

# A draw chooses among what may be chosen when its turn comes. Most sequences begin with a rack that
# is pulled out, and with none out dishes are seldom picked, lest everything goes to the sink.
KINDS = ("joint", "dish", "dish", "dish", "anything")
OPENINGS = (
    [],
    [("joint", DOOR), ("joint", BOTTOM_RACK)],
    [("joint", DOOR), ("joint", TOP_RACK)],
)
DRAWS = st.builds(
    lambda opening, rest: opening + rest,
    st.sampled_from(OPENINGS),
    st.lists(st.tuples(st.sampled_from(KINDS), st.integers(0, 999)), min_size=40, max_size=120),
)
SESSIONS = st.tuples(st.sampled_from(["seen", "unseen_both"]), st.integers(0, 69))


def new_kitchen(split="seen", index=0):
    return Kitchen(make_session(split, index).dishes)


def drawn_instance(kitchen, kind, number):
    """The instance that a draw names: a place with a dish in hand, else an object."""
    if kind == "anything":
        options = ANYTHING
    elif kitchen.held is not None:
        first = FIRST_PLACEMENT.get(kitchen.open_rack, 0)
        options = [*(first + kitchen.placements()).tolist(), SINK]
    elif kind == "dish" and kitchen.open_rack is not None and len(kitchen.counter) > 0:
        options = (FIRST_DISH + kitchen.counter).tolist()
    else:
        options = JOINTS
    return options[number % len(options)]


def walk(session, seed, length=120):
    """A kitchen after a seeded sequence of draws, and the decisions that they came to."""
    generator = np.random.default_rng(seed)
    kinds, numbers = generator.choice(KINDS, length), generator.integers(1000, size=length)
    draws = OPENINGS[1 + seed % 2] + list(zip(kinds, numbers.tolist(), strict=True))
    kitchen, decisions = new_kitchen(*session), []
    for draw in draws:
        decisions.append(drawn_instance(kitchen, *draw))
        kitchen.decide(decisions[-1])
    return kitchen, decisions


class Witness:
    """Remembers, from the accepted decisions alone, what was put where and which rack is out."""

    def __init__(self):
        self.put = {}  # dish -> "bottom", "top" or "sink"
        self.open_rack = None

    def see(self, held, instance):
        if held is not None:
            racks = {first // 1000: rack for rack, first in FIRST_PLACEMENT.items()}
            self.put[held] = racks.get(instance // 1000, "sink")
        for rack, joint in RACK_INSTANCE.items():
            if held is None and instance == joint:
                self.open_rack = rack if self.open_rack is None else None


def assert_no_two_dishes_block_each_other(kitchen):
    blocks = placement_table().blocks
    for rack, where in IN_RACK.items():
        standing = kitchen.placement[kitchen.location == where]
        between = blocks[np.ix_(standing, standing)]  # each placement blocks itself
        assert between.sum() == len(standing), f"dishes in the {rack} rack block each other"


@settings(max_examples=60, deadline=None)
@given(SESSIONS, DRAWS)
def test_no_sequence_of_decisions_breaks_the_rules(session, draws):
    kitchen, witness = new_kitchen(*session), Witness()
    n = len(kitchen.location)
    for kind, number in draws:
        instance = drawn_instance(kitchen, kind, number)
        digest, held, places = kitchen.digest(), kitchen.held, kitchen.location.copy()
        refusal = kitchen.decide(instance)
        assert bool(refusal) == (kitchen.digest() == digest)  # refused: nothing changed
        if not refusal:
            witness.see(held, instance)

        count = np.bincount(kitchen.location, minlength=len(Location))
        assert len(count) == len(Location)
        assert count.sum() == n
        away = places > Location.COUNTER
        assert (kitchen.location[away] == places[away]).all(), "a dish that was put away moved"
        assert (kitchen.location[places == Location.COUNTER] != Location.NOT_ARRIVED).all()
        assert kitchen.door_open or kitchen.open_rack is None
        assert_no_two_dishes_block_each_other(kitchen)

        visible = set(kitchen.visible_dishes().tolist())
        for dish, where in witness.put.items():
            assert (dish in visible) == (where == witness.open_rack), f"dish {dish} in {where}"


def test_such_sequences_rack_dishes_and_are_carried_out_and_refused():
    for index in range(70):
        kitchen, decisions = walk(("seen", index), seed=index, length=60)
        assert (kitchen.placement >= 0).sum() >= 4
        again = new_kitchen("seen", index)
        refused = [bool(again.decide(decision)) for decision in decisions]
        assert 0.2 < np.mean(refused) < 0.8


def test_the_same_decisions_give_the_same_states_in_another_process():
    sessions = [("unseen_both", 9 * seed) for seed in range(12)]
    walks = [walk(session, seed) for seed, session in enumerate(sessions)]
    script = (
        "import json, sys\n"
        "from kitchen_prefs.simulation.kitchen import Kitchen\n"
        "from kitchen_prefs.simulation.sessions import make_session\n"
        "for session, decisions in json.load(sys.stdin):\n"
        "    kitchen = Kitchen(make_session(*session).dishes)\n"
        "    for decision in decisions: kitchen.decide(decision)\n"
        "    print(kitchen.digest())"
    )
    batch = [(session, decisions) for session, (_, decisions) in zip(sessions, walks, strict=True)]
    done = subprocess.run(
        [sys.executable, "-c", script],
        input=json.dumps(batch),
        capture_output=True,
        text=True,
        check=True,
    )
    digests = [kitchen.digest() for kitchen, _ in walks]
    assert len(set(digests)) == len(digests)
    assert done.stdout.split() == digests


def test_a_newly_opened_kitchen():
    kitchen = new_kitchen()
    assert kitchen.closed
    assert not kitchen.finished
    assert len(kitchen.visible_dishes()) == kitchen.dishes.present


def test_the_door_moves_only_with_both_racks_in():
    kitchen = new_kitchen()
    assert kitchen.decide(DOOR) == ""
    assert kitchen.decide(TOP_RACK) == ""
    assert "both racks in" in kitchen.decide(DOOR)
    assert kitchen.decide(TOP_RACK) == ""
    assert kitchen.decide(DOOR) == ""
    assert kitchen.closed


def test_a_rack_moves_only_with_the_door_open_and_the_other_in():
    kitchen = new_kitchen()
    assert "door open" in kitchen.decide(BOTTOM_RACK)
    kitchen.decide(DOOR)
    kitchen.decide(TOP_RACK)
    assert "other rack in" in kitchen.decide(BOTTOM_RACK)


def two_alike(kitchen):
    """Two dishes of one category on the counter."""
    category = kitchen.dishes.category[kitchen.counter]
    alike = next(c for c in range(len(CATEGORIES)) if (category == c).sum() > 1)
    return kitchen.counter[category == alike][:2].tolist()


def test_a_dish_goes_only_into_a_free_placement_of_the_open_rack():
    kitchen = new_kitchen()
    kitchen.decide(DOOR)
    kitchen.decide(TOP_RACK)
    dish, like = two_alike(kitchen)
    kitchen.decide(FIRST_DISH + dish)
    placement = int(kitchen.free("top", int(kitchen.dishes.category[dish]))[0])
    assert "rack that is out" in kitchen.decide(FIRST_PLACEMENT["bottom"] + placement)
    assert kitchen.decide(FIRST_PLACEMENT["top"] + placement) == ""
    assert "Only a dish on the counter" in kitchen.decide(FIRST_DISH + dish)
    kitchen.decide(FIRST_DISH + like)
    assert "blocked" in kitchen.decide(FIRST_PLACEMENT["top"] + placement)


def test_a_sunk_dish_leaves_the_set():
    kitchen = new_kitchen()
    dish = int(kitchen.counter[0])
    kitchen.decide(FIRST_DISH + dish)
    assert kitchen.decide(SINK) == ""
    assert dish not in kitchen.visible_dishes()


def test_dishes_to_come_arrive_once_the_counter_is_cleared():
    kitchen = next(
        kitchen for kitchen in (new_kitchen(index=i) for i in range(70)) if not kitchen.all_arrived
    )
    for dish in kitchen.counter:
        assert not kitchen.finished
        kitchen.decide(FIRST_DISH + int(dish))
        kitchen.decide(SINK)
    assert len(kitchen.counter) == 1


def test_dishes_arrive_in_the_end_even_if_the_counter_is_never_cleared():
    kitchen = next(
        kitchen for kitchen in (new_kitchen(index=i) for i in range(70)) if not kitchen.all_arrived
    )
    for _ in range(ARRIVALS_AT_LATEST + len(kitchen.location)):
        kitchen.decide(DOOR)
    assert kitchen.all_arrived

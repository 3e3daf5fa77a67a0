"""The simulated drawers: what holds whatever is decided, and what the expert does."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs import instances
from kitchen_prefs_robot.task.decisions import Pick, Place, Toggle, choices, is_finished, refusal
from kitchen_prefs_robot.task.expert import choose
from kitchen_prefs_robot.task.metrics import episode_of, right_dishes, right_drawer
from kitchen_prefs_robot.task.preferences import LABELS
from kitchen_prefs_robot.task.rows import drop_position, observe
from kitchen_prefs_robot.task.sessions import make_session
from kitchen_prefs_robot.task.simulator import DrawersSimulator, Perception

SESSIONS = st.builds(make_session, st.sampled_from(sorted(LABELS)), st.integers(0, 2000))
# Each number names one of the choices of its state, wherever it leads.
DECISIONS = st.lists(st.integers(0, 2**16), max_size=40)


def play(simulator, numbers):
    for number in numbers:
        possible = choices(simulator.seen)
        yield simulator.decide(possible[number % len(possible)])


@given(SESSIONS, DECISIONS)
@settings(deadline=None, max_examples=60)
def test_what_holds_whatever_is_decided(session, numbers):
    simulator = DrawersSimulator(session)
    before = simulator.state
    for refused in play(simulator, numbers):
        state = simulator.state
        assert not refused or state == before
        assert len(state.dishes) + (state.in_hand is not None) == len(session.start.dishes)
        for dish in state.dishes:
            assert dish.drawer is None or dish.position == drop_position(dish.drawer)
            assert dish.drawer is not None or dish in session.start.dishes
        rows = observe(state, len(simulator.decisions))
        assert len(rows) == len(choices(state))
        assert instances.pack(rows).shape == (instances.CAPACITY, instances.COLUMNS)
        assert instances.is_real(rows).all()
        before = state


@given(SESSIONS, DECISIONS)
@settings(deadline=None, max_examples=60)
def test_the_expert_finishes_from_every_state(session, numbers):
    simulator = DrawersSimulator(session)
    list(play(simulator, numbers))
    wrong = sum(
        dish.drawer not in (None, session.preference.drawer_of[dish.category])
        for dish in simulator.dishes
    )
    in_hand = simulator.state.in_hand
    wrong += in_hand is not None and session.preference.drawer_of[in_hand] != simulator.opened
    for _ in range(30):
        if is_finished(simulator.state):
            break
        assert not simulator.decide(choose(simulator.state, session.preference))
    assert simulator.terminated
    right = 1 - wrong / len(simulator.dishes)
    assert np.isclose(right_drawer(episode_of(simulator)), right)


@given(SESSIONS)
@settings(deadline=None, max_examples=60)
def test_the_expert_loads_all_dishes_by_the_preference_in_one_go(session):
    simulator = DrawersSimulator(session)
    while not simulator.terminated:
        simulator.decide(choose(simulator.state, session.preference))
    episode = episode_of(simulator)
    assert right_dishes(episode) == 1
    assert not any(episode.refused)
    assert len(episode.decisions) == 2 * len(simulator.dishes) + 4 == simulator.limit / 2
    drawers = [decision.drawer for decision in simulator.decisions if isinstance(decision, Toggle)]
    first, second = session.preference.drawers
    assert drawers == [first, first, second, second]


def test_refusals():
    start = make_session("test", 0).start
    upper = replace(start, opened="upper")
    holding = replace(upper, dishes=start.dishes[1:], in_hand=start.dishes[0].category)
    in_drawer = replace(start.dishes[0], drawer="upper")
    loaded = replace(upper, dishes=(in_drawer, *start.dishes[1:]))
    assert refusal(start, Pick(0)) == (
        "A dish is picked only for an open drawer, and both are closed."
    )
    assert refusal(start, Place("upper")) == "There is no dish in hand."
    assert refusal(upper, Toggle("lower")) == "A drawer moves only with the other one closed."
    assert refusal(holding, Toggle("upper")).startswith("The hand holds a dish")
    assert refusal(holding, Place("lower")) == "A dish goes only into the open drawer."
    assert (
        refusal(loaded, Pick(0))
        == "Only a dish on the table can be picked; one in a drawer stays there."
    )
    for state, decision in ((upper, Pick(0)), (holding, Place("upper")), (loaded, Toggle("upper"))):
        assert not refusal(state, decision)


def test_noise_moves_the_dishes_on_the_table_anew_at_each_look():
    session = make_session("test", 0)
    simulator = DrawersSimulator(session, Perception(noise=0.008))
    errors = []
    for _ in range(200):
        seen, true = simulator.seen.dishes, simulator.state.dishes
        errors += [np.subtract(s.position, t.position) for s, t in zip(seen, true, strict=True)]
        simulator.decide(Pick(0))  # refused: nothing changes but the look
    assert 0.0075 < np.std(errors) < 0.0085
    simulator.decide(Toggle("upper"))
    simulator.decide(Pick(2))
    simulator.decide(Place("upper"))
    assert simulator.seen.dishes[2].position == drop_position("upper")


def test_one_dish_in_ten_is_misread_from_first_to_last_as_another_of_the_session():
    wrong = total = 0
    for index in range(300):
        simulator = DrawersSimulator(make_session("test", index), Perception(misread=0.1))
        seen = [dish.category for dish in simulator.seen.dishes]
        true = [dish.category for dish in simulator.state.dishes]
        wrong += sum(s != t for s, t in zip(seen, true, strict=True))
        total += len(true)
        assert set(seen) <= set(simulator.session.preference.categories)
        simulator.decide(Toggle("upper"))
        assert [dish.category for dish in simulator.seen.dishes] == seen
    assert 0.07 < wrong / total < 0.13

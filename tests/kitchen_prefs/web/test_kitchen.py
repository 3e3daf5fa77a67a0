"""The kitchen in JavaScript carries out and refuses what the kitchen in Python does."""

import json

import numpy as np
import pytest
from chromium import bare_page, needs_chromium
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from kitchen_prefs.simulation import kitchen as k
from kitchen_prefs.simulation.expert import KitchenView, choose
from kitchen_prefs.simulation.kitchen import Kitchen, Location
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs.web.kitchen_data import layout_data, session_data
from kitchen_prefs.web.page import SHARED, joined

SPLITS = ("seen", "unseen_counts", "many_preferences", "noisy")
SESSIONS_OF_EACH = 12
EXPERT_SHARE = 0.3  # so that arbitrary decisions come in every state, and sessions end
LONGEST = 200  # decisions
PLACES = {
    Location.NOT_ARRIVED: "to arrive",
    Location.COUNTER: "counter",
    Location.BOTTOM: "bottom",
    Location.TOP: "top",
    Location.SINK: "sink",
}
# What the browser does with each session's decisions; as texts, lists cross over much faster.
CARRY_OUT = """(trials) => JSON.stringify(JSON.parse(trials).map(([session, decisions]) => {
    const state = kitchenAtStart(session);
    return decisions.map((instance) => {
        const before = JSON.stringify(state);
        const foreseen = refusal(state, instance);
        const told = decide(state, instance);
        if (told !== foreseen || (told !== "" && JSON.stringify(state) !== before)) throw told;
        const { doorOpen, out, held, places, placements, completed } = state;
        return structuredClone([told, doorOpen, out, held, places, placements, completed,
            isClosed(state), allArrived(state), isFinished(state), counterDishes(state),
            visibleDishes(state), placementsInHand(state),
            ["bottom", "top"].map((rack) => freePlacements(state, rack, completed % 7))]);
    });
}))"""

pytestmark = [
    pytest.mark.xdist_group("kitchen_in_javascript"),
    pytest.mark.browser,
    needs_chromium,
]


def arbitrary_decision(kitchen, generator):
    """Any instance, most often one that a decision could name now, and some that nobody has."""
    objects = [k.DOOR, k.BOTTOM_RACK, k.TOP_RACK, *range(3, 4 + len(kitchen.location))]
    placement = generator.integers(len(k.placement_table().category))
    if len(kitchen.placements()) and generator.random() < 0.8:
        placement = generator.choice(kitchen.placements())
    racks = list(k.FIRST_PLACEMENT) + [kitchen.open_rack or "top"] * 3
    place = k.FIRST_PLACEMENT[str(generator.choice(racks))] + int(placement)
    decide_on_place = generator.random() < (0.2 if kitchen.held is None else 0.8)
    if decide_on_place:
        return place if generator.random() < 0.9 else k.SINK
    return int(generator.choice([*objects, -1, 500, 1999, 5000]))


def state_of(kitchen):
    """What the browser tells of its state."""
    category = kitchen.completed % 7
    return [
        kitchen.door_open,
        kitchen.open_rack,
        kitchen.held,
        [PLACES[location] for location in kitchen.location],
        [None if placement < 0 else placement for placement in kitchen.placement.tolist()],
        kitchen.completed,
        kitchen.closed,
        kitchen.all_arrived,
        kitchen.finished,
        kitchen.counter.tolist(),
        kitchen.visible_dishes().tolist(),
        kitchen.placements().tolist(),
        [kitchen.free(rack, category).tolist() for rack in ("bottom", "top")],
    ]


def trial(session, generator):
    """Decisions of the expert and arbitrary ones in turn, and what the kitchen makes of each."""
    kitchen = Kitchen(session.dishes)
    view = KitchenView(kitchen)
    decisions, told = [], []
    while not kitchen.finished and len(decisions) < LONGEST:
        if generator.random() < EXPERT_SHARE:
            instance = int(choose(view, session.preference))
        else:
            instance = arbitrary_decision(kitchen, generator)
        decisions.append(instance)
        told.append([kitchen.decide(instance), *state_of(kitchen)])
    return decisions, told


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page with the kitchen's rules and nothing to see."""
    file = tmp_path_factory.mktemp("kitchen") / "kitchen.html"
    script = joined(SHARED / "basics.js", SHARED / "kitchen.js", SHARED / "replay.js")
    with bare_page(file, script, {"layout": layout_data()}) as page:
        yield page


def test_arbitrary_decisions_change_the_same_or_are_refused_in_the_same_words(page):
    generator = np.random.default_rng(0)
    sessions = [make_session(split, i) for split in SPLITS for i in range(SESSIONS_OF_EACH)]
    trials = [trial(session, generator) for session in sessions]
    asked = [
        (session_data(session), decisions)
        for session, (decisions, _) in zip(sessions, trials, strict=True)
    ]
    decided = json.loads(page.evaluate(CARRY_OUT, json.dumps(asked)))
    for session, (decisions, told), found in zip(sessions, trials, decided, strict=True):
        for step, (instance, wanted, got) in enumerate(zip(decisions, told, found, strict=True)):
            assert got == wanted, f"{session.split} {session.index}, step {step}: {instance}"
    all_told = [one for _, told in trials for one in told]
    assert len(all_told) > 4000
    assert len({refusal for refusal, *_ in all_told}) == 7  # every sentence, and none
    assert sum(state[9] for state in all_told) > 10  # finished sessions


EXPERT = -2  # in the place of a decision: what the expert would decide now
PLACEMENTS = len(k.placement_table().category)
DECISIONS = st.lists(
    st.one_of(
        st.just(EXPERT),
        st.integers(-1, k.FIRST_DISH + 20),
        st.just(k.SINK),
        st.integers(k.FIRST_PLACEMENT["bottom"], k.FIRST_PLACEMENT["bottom"] + PLACEMENTS),
        st.integers(k.FIRST_PLACEMENT["top"], k.FIRST_PLACEMENT["top"] + PLACEMENTS),
    ),
    max_size=60,
)


@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(split=st.sampled_from(SPLITS), index=st.integers(0, SESSIONS_OF_EACH - 1), asked=DECISIONS)
def test_any_decisions_do_the_same(page, split, index, asked):
    session = make_session(split, index)
    kitchen = Kitchen(session.dishes)
    view = KitchenView(kitchen)
    decisions, told = [], []
    for instance in asked:
        if kitchen.finished:
            break
        decisions.append(int(choose(view, session.preference)) if instance == EXPERT else instance)
        told.append([kitchen.decide(decisions[-1]), *state_of(kitchen)])
    trials = json.dumps([(session_data(session), decisions)])
    assert json.loads(page.evaluate(CARRY_OUT, trials)) == [told]


def test_the_experts_decisions_are_not_refused_and_finish_the_session(page):
    sessions = [make_session("unseen_both", i) for i in range(10)]
    ends = page.evaluate(
        """(sessions) => sessions.map((session) => {
            const state = kitchenAtStart(session);
            const told = session.expert.map((instance) => decide(structuredClone(state), instance)
                || decide(state, instance));
            return [told.every((one) => one === ""), isFinished(state)];
        })""",
        [session_data(session) for session in sessions],
    )
    assert ends == [[True, True]] * len(sessions)


def test_a_replay_tells_each_decision_in_words(page):
    session = make_session("seen", 0)
    decisions = [k.TOP_RACK, *expert_trajectory(session).decisions]
    told = page.evaluate(
        "([session, decisions]) => replay(session, decisions, [0]).map(({ text }) => text)",
        [session_data(session), decisions],
    )
    assert told[:3] == [
        "before the first decision",
        "refused: pulls the top rack out. A rack moves only with the door open.",
        "opens the door",
    ]
    assert told[-1] == "closes the door"

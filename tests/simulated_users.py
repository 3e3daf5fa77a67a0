"""Users who load by a preference, perhaps with slips at a known rate, and the files they give."""

import numpy as np

from kitchen_prefs.preferences import CATEGORIES, SPACE_SIZE, preference_from_number
from kitchen_prefs.simulation.expert import KitchenView, choose, roll_out_expert
from kitchen_prefs.simulation.kitchen import (
    DOOR,
    FIRST_DISH,
    FIRST_PLACEMENT,
    RACK_INSTANCE,
    SINK,
    Kitchen,
)
from kitchen_prefs_demonstrations.file_format import DemonstrationFile
from kitchen_prefs_demonstrations.kitchens import study_session
from kitchen_prefs_demonstrations.replaying import replay

# Ten preferences, spread over all 2 x 7!; none is one of the twelve.
NUMBERS = tuple(range(500, 10_080, 1_000))


def content_of(session, preference, **changes):
    """The content of the file of a demonstration by the expert of a preference."""
    decisions = list(roll_out_expert(Kitchen(session.dishes), preference).decisions)
    start = {"split": session.split, "session": session.index, "salt": session.salt}
    person = {"user": "Ada", "consent": True, "study": None}
    return {"format": 1, "data_version": 1} | start | {"decisions": decisions} | person | changes


def preference_of(number):
    """The preference of a user, drawn at random from all 2 x 7!."""
    return preference_from_number(int(np.random.default_rng(number).integers(SPACE_SIZE)))


def slipping(session, preference, rate, seed):
    """The decisions of a user who puts each dish into the sink at a rate, by mistake."""
    generator = np.random.default_rng(seed)
    kitchen = Kitchen(session.dishes)
    view = KitchenView(kitchen)
    decisions = []
    while not kitchen.finished:
        instance = choose(view, preference)
        if kitchen.held is not None and generator.random() < rate:
            instance = SINK
        decisions.append(instance)
        kitchen.decide(instance)
    return decisions


def loading_by_rack(session, on_top):
    """The decisions of a user who puts some categories on top, more or fewer than a preference."""
    kitchen = Kitchen(session.dishes)
    decisions = []

    def decide(instance):
        assert not kitchen.decide(instance)
        decisions.append(instance)

    def load(rack):
        names = {i: CATEGORIES[session.dishes.category[i]] for i in kitchen.counter.tolist()}
        own = [i for i, name in names.items() if (name in on_top) == (rack == "top")]
        if not own:
            return
        decide(RACK_INSTANCE[rack])
        for dish in own:
            decide(FIRST_DISH + dish)
            free = kitchen.free(rack, int(session.dishes.category[dish]))
            decide(FIRST_PLACEMENT[rack] + int(free[0]))
        decide(RACK_INSTANCE[rack])

    decide(DOOR)
    while len(kitchen.counter):
        load("top")
        load("bottom")
    decide(DOOR)
    return decisions


def demonstrated(decisions, user, day, session=None):
    """Decisions as a replayed demonstration of a study."""
    session = session or study_session()
    file = DemonstrationFile(
        format=1,
        data_version=1,
        split=session.split,
        session=session.index,
        salt=session.salt,
        decisions=decisions,
        study={"name": "test", "participant": f"p{user}", "day": day},
    )
    return replay(file, f"p{user}")


def study_of(users, rate):
    """Every user twice, in the study's kitchen."""
    session = study_session()
    return [
        demonstrated(
            slipping(session, preference_of(user), rate, [user, day, round(rate * 1000)]), user, day
        )
        for user in range(users)
        for day in (1, 2)
    ]


def dishes_of(session):
    """How many dishes of each category a session has."""
    return np.bincount(session.dishes.category)

"""What a session shows before its first decision tells nothing of its user."""

from collections import Counter

import numpy as np
import pytest
from sklearn.linear_model import LogisticRegression
from sklearn.model_selection import cross_val_predict
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler

from kitchen_prefs.people.attributes import CLASSES
from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.people.splits import PEOPLE_SPLITS

FRESH = 4000  # starts with a session seed that no published session has
SALT = 77
FIRST = 4  # dishes whose kind and place are told one by one, in the order of their arrival
# Of seven rules none may be guessed better than chance by more than so many standard errors: that
# happens by accident once in 600 runs of all seven.
DEVIATIONS = 3.5

RULES = {
    "hand": lambda user: user.hand is not None,
    "exceptions": lambda user: len(user.exceptions),
    "base": lambda user: user.base.scheme,
    "overflow": lambda user: user.overflow,
    "first": lambda user: user.first,
    "order": lambda user: user.order.scheme if user.order else "none",
    "style": lambda user: user.style,
}


def start(session):
    """What is seen at the start: counts of all classes, how many dishes, and the first ones."""
    dishes, present = session.dishes, session.dishes.present
    seen = np.arange(len(dishes.category)) < present
    counts = [
        np.bincount(dishes.classes(scheme)[seen], minlength=len(names))
        for scheme, names in CLASSES.items()
    ]
    first = [dishes.category[:FIRST], dishes.material[:FIRST], dishes.colour[:FIRST]]
    poses = dishes.pose[:FIRST, :2].ravel()
    middle = dishes.pose[:present, :2].mean(axis=0)
    return np.concatenate([*counts, [present, dishes.greasy[seen].sum()], *first, poses, middle])


def fresh():
    return [make_people_session("people_train", index, SALT) for index in range(FRESH)]


def published():
    """The sessions of the certified splits, which were chosen by what their prompts tell."""
    return [
        make_people_session(split.name, index)
        for split in PEOPLE_SPLITS.values()
        if split.certified and not split.composed
        for index in range(split.sessions)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("sessions", [fresh, published])
def test_a_start_tells_nothing_of_any_rule(sessions):
    shown = sessions()
    starts = np.stack([start(session) for session in shown])
    for name, rule in RULES.items():
        rules = np.array([str(rule(session.user)) for session in shown])
        model = make_pipeline(StandardScaler(), LogisticRegression(C=0.01, max_iter=200))
        right = (cross_val_predict(model, starts, rules, cv=4) == rules).mean()
        chance = Counter(rules.tolist()).most_common(1)[0][1] / len(rules)
        error = np.sqrt(chance * (1 - chance) / len(rules))
        assert right < chance + DEVIATIONS * error, f"the start tells of {name}"

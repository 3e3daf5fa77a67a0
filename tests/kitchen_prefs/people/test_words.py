"""A user in words."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kitchen_prefs.people.user_sampling import sample_user
from kitchen_prefs.people.users import ByClass, Predicate, User, ZoneException
from kitchen_prefs.people.words import user_in_words

seeds = st.integers(0, 10**6)


def test_every_rule_has_its_sentence():
    user = User(
        hand=Predicate(material=3),
        exceptions=(
            ZoneException(Predicate(category=0, colour=1), 2),
            ZoneException(Predicate(greasy=True), 1),
        ),
        base=ByClass("family", (0, 3, 3, 2)),
        overflow="other rack, then other side",
        first="bottom",
        order=ByClass("size", (1, 2, 0)),
        style="near right corner",
    )
    assert user_in_words(user) == (
        "Wash dishes of wood by hand: put them into the sink. "
        "Put blue cups on the left of the bottom rack, whatever else they are. "
        "Of the rest, put greasy dishes on the right of the top rack, whatever else they are. "
        "Of all others, put cups and glasses on the left of the top rack; trays on the left of the "
        "bottom rack; bowls and plates on the right of the bottom rack. "
        "When a place is full, try the other rack, then the other side of its rack, and last the "
        "sink. "
        "Load the bottom rack first, and in each rack large dishes, then small dishes, then "
        "middling dishes. "
        "Fill each place from its near right corner."
    )


@given(seeds, seeds)
def test_users_have_the_same_words_if_they_are_the_same(one, other):
    first, second = (sample_user(np.random.default_rng(seed)) for seed in (one, other))
    assert (user_in_words(first) == user_in_words(second)) == (first == second)

"""Users of the second tier: total on any dish, and drawn as the grammar says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kitchen_prefs.people.attributes import (
    CLASSES,
    COMES_IN,
    MATERIALS,
    draw_dishes,
)
from kitchen_prefs.people.user_sampling import (
    COMPOSED,
    EXCEPTION_KINDS,
    is_base,
    pairs_of,
    sample_polled_user,
    sample_user,
)
from kitchen_prefs.people.users import (
    SCHEMES,
    ByClass,
    Predicate,
    User,
    ZoneException,
    every_exception,
)
from kitchen_prefs.people.zones import RACK_OF_ZONE, SINK_ZONE, ZONES
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.placements import LARGEST

seeds = st.integers(0, 10**6)


@given(seeds)
def test_a_user_has_a_zone_or_washes_by_hand_whatever_the_dish(seed):
    generator = np.random.default_rng(seed)
    user, dishes = sample_user(generator), draw_dishes(16, generator)
    zones = user.zones(dishes)
    by_hand = user.hand.matches(dishes) if user.hand else np.zeros(16, dtype=bool)
    assert ((zones == SINK_ZONE) == by_hand).all()
    assert ((zones >= 0) & (zones <= SINK_ZONE)).all()
    assert is_base(user.base.values)


@given(seeds, st.integers(7, 18))
def test_dishes_are_what_their_category_comes_in(seed, count):
    dishes = draw_dishes(count, np.random.default_rng(seed))
    assert set(dishes.category.tolist()) == set(range(len(CATEGORIES)))
    for category, material in zip(dishes.category, dishes.material, strict=True):
        assert MATERIALS[material] in COMES_IN[CATEGORIES[category]]
    assert (abs(dishes.scale - 1) <= LARGEST - 1 + 1e-6).all()
    assert count / 2 - 1 <= dishes.present <= count
    for scheme in SCHEMES:
        classes = dishes.classes(scheme)
        assert ((classes >= 0) & (classes < len(CLASSES[scheme]))).all()


def test_the_first_exception_that_matches_counts_and_hand_wash_before_all():
    dishes = draw_dishes(18, np.random.default_rng(4))
    blue, greasy, wood = Predicate(colour=1), Predicate(greasy=True), Predicate(material=3)
    base = ByClass("colour", (0, 0, 1, 3))
    exceptions = (ZoneException(blue, 2), ZoneException(greasy, 3))
    user = User(wood, exceptions, base, "sink", "top", None, "far left corner")
    for i, zone in enumerate(user.zones(dishes)):
        if dishes.material[i] == 3:
            assert zone == SINK_ZONE
        elif dishes.colour[i] == 1:
            assert zone == 2
        elif dishes.greasy[i]:
            assert zone == 3
        else:
            assert zone == base.values[dishes.colour[i]]


def test_kinds_of_exceptions_are_equally_frequent():
    assert {predicate.kind for predicate in every_exception()} == set(EXCEPTION_KINDS)
    users = [sample_user(np.random.default_rng(seed)) for seed in range(1500)]
    kinds = [one.predicate.kind for user in users for one in user.exceptions]
    assert len(kinds) / len(users) == pytest.approx(1.1, abs=0.06)
    for kind in EXCEPTION_KINDS:
        assert kinds.count(kind) / len(kinds) == pytest.approx(0.2, abs=0.04)
    assert any(pairs_of(user) & COMPOSED for user in users)


def test_polled_users_have_cups_on_top_and_plates_below_more_often():
    users = [sample_polled_user(np.random.default_rng(seed)) for seed in range(600)]
    racks = {"cup": [], "small plate": []}
    for user in users:
        if user.base.scheme == "category":
            for name, values in racks.items():
                zone = user.base.values[CATEGORIES.index(name)]
                values.append(RACK_OF_ZONE[zone] == "top")
    assert np.mean(racks["cup"]) > 0.65
    assert np.mean(racks["small plate"]) < 0.35
    assert len(ZONES) == 4

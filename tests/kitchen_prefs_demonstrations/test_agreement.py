"""Agreement of simulated users, who agree with themselves as far as is known."""

from dataclasses import replace
from math import comb

import numpy as np
import pytest
from simulated_users import demonstrated, dishes_of, preference_of, slipping, study_of

from kitchen_prefs.metrics import Interval
from kitchen_prefs_demonstrations.agreement import agreement
from kitchen_prefs_demonstrations.comparison import MEASURES, compare, traits_of, where
from kitchen_prefs_demonstrations.habits import habit_of, occasions_of, turns
from kitchen_prefs_demonstrations.kitchens import page_sessions, study_session

USERS = 8


@pytest.fixture(scope="module")
def steady():
    return study_of(USERS, rate=0.0)


def test_a_user_who_never_slips_agrees_with_herself(steady):
    found = agreement(steady)
    assert found.users == USERS
    assert found.pairs == {"self": USERS, "others": 4 * USERS * (USERS - 1) // 2}
    assert found.measures["self"] == dict.fromkeys(MEASURES, Interval(1, 1, 1))
    for name, interval in found.measures["others"].items():
        assert interval.low < interval.mean < interval.high < 1, name


def test_a_habit_is_the_preference_of_its_user():
    for user in range(5):
        preference = preference_of(user)
        shown = demonstrated(slipping(study_session(), preference, 0, 0), user, 1)
        habit = habit_of(shown)
        assert habit.rack_of == preference.rack_of
        right, counted = turns(occasions_of(shown), habit)
        assert right == counted > 0


def test_a_user_agrees_with_herself_where_dishes_arrive_later():
    for number, session in enumerate(page_sessions(10)):
        preference = preference_of(number)
        shown = traits_of(demonstrated(slipping(session, preference, 0, 0), 0, 1, session))
        assert compare(shown, shown)["Turn"] in (1, None)


def same_place(count, rate):
    """The expected number of like dishes in the same place of two demonstrations.

    Each is in the rack with probability 1 - rate, else in the sink: X and Y of them are in the
    rack, and count - |X - Y| agree.
    """
    chance = [comb(count, k) * (1 - rate) ** k * rate ** (count - k) for k in range(count + 1)]
    apart = np.abs(np.subtract.outer(range(count + 1), range(count + 1)))
    return count - float(np.array(chance) @ apart @ np.array(chance))


@pytest.mark.parametrize("rate", [0.05, 0.2])
def test_the_known_agreement_of_users_who_slip_is_found(rate):
    session = study_session()
    known = sum(same_place(int(n), rate) for n in dishes_of(session)) / len(session.dishes.category)
    found = agreement(study_of(16, rate)).measures["self"]["Where"]
    # A slip moves what comes later, perhaps into the other half of its rack: a little is lost.
    assert known - 0.1 < found.mean < known + 0.03
    assert found.low < found.mean < found.high


def test_users_of_two_minds_agree_as_often_as_their_minds_meet():
    """A quarter of the days are of the other mind: of 16 users, 10 have both days of one."""
    session = study_session()
    shown, known = [], []
    for user, days in enumerate([(0, 0)] * 9 + [(0, 1)] * 3 + [(1, 0)] * 3 + [(1, 1)]):
        minds = [slipping(session, preference_of(100 * mind + user), 0, 0) for mind in (0, 1)]
        both = [demonstrated(minds[mind], user, day) for day, mind in enumerate(days, 1)]
        shown += both
        known.append(1 if days[0] == days[1] else where(*map(traits_of, both)))
    found = agreement(shown).measures["self"]["Where"]
    assert sum(value < 1 for value in known) == 6
    assert found.mean == pytest.approx(np.mean(known))
    assert found.low < found.mean < found.high


def test_it_does_not_depend_on_who_comes_first(steady):
    one, other = traits_of(steady[0]), traits_of(steady[2])
    assert compare(one, other) == pytest.approx(compare(other, one))
    found, turned = agreement(steady[:6]), agreement(steady[:6][::-1])
    for group in ("self", "others"):
        for name, interval in found.measures[group].items():
            assert turned.measures[group][name].mean == pytest.approx(interval.mean)


def test_what_cannot_be_compared_is_said(steady):
    nameless = replace(steady[0], file=steady[0].file.model_copy(update={"study": None}))
    with pytest.raises(ValueError, match="names neither a user nor a participant"):
        agreement([nameless, steady[1]])
    with pytest.raises(ValueError, match="test/p0 has 2 demonstrations of day 1; leave one"):
        agreement([steady[0], *steady])
    with pytest.raises(ValueError, match="No two demonstrations start in the same kitchen"):
        agreement(steady[:1])

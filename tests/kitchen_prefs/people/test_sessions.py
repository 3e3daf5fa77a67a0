"""Sessions of the second tier: pure, of disjoint users, certified where the split says so."""

import numpy as np
import pytest

from kitchen_prefs.people.certificates import certificate
from kitchen_prefs.people.posterior import Posterior
from kitchen_prefs.people.sessions import make_people_session, people_table
from kitchen_prefs.people.splits import COUNTS, PEOPLE_SPLITS, SLIPS
from kitchen_prefs.people.user_sampling import COMPOSED, pairs_of
from kitchen_prefs.preferences import CATEGORIES

FEW = 2


@pytest.mark.parametrize("name", PEOPLE_SPLITS)
def test_a_session_is_what_its_split_says(name):
    split = PEOPLE_SPLITS[name]
    for index in range(FEW):
        session = make_people_session(name, index)
        assert len(session.dishes.category) == split.count(index)
        assert len(session.prompts) == split.prompts
        assert bool(pairs_of(session.user) & COMPOSED) == split.composed
        for prompt in session.prompts:
            assert len(prompt.dishes.category) in COUNTS
            kinds = len(np.unique(prompt.dishes.category))
            assert kinds == len(CATEGORIES) - split.lacking
        if split.certified:
            evidence = [prompt.evidence for prompt in session.own_prompts]
            assert certificate(Posterior(evidence), session.dishes, people_table()).holds


def test_a_session_is_the_same_in_every_process():
    first = make_people_session("people_three", 5)
    make_people_session.cache_clear()
    again = make_people_session("people_three", 5)
    assert again is not first
    assert again.user == first.user
    assert np.array_equal(again.dishes.pose, first.dishes.pose)
    assert again.expert.trajectory.decisions == first.expert.trajectory.decisions


def test_another_session_seed_gives_other_users():
    one, other = (make_people_session("people_val", 3, salt) for salt in (0, 1))
    assert one.user != other.user
    assert not np.array_equal(one.dishes.category, other.dishes.category)


def test_users_of_training_have_two_sessions_that_prompt_each_other():
    for index in (0, 2, 4):
        one, other = (make_people_session("people_train", index + i) for i in (0, 1))
        assert one.user == other.user
        assert one.prompts[0].dishes is other.dishes
        assert other.prompts[0].dishes is one.dishes


def test_slips_are_as_frequent_as_they_should_be():
    slipped = []
    for index in range(12):
        session = make_people_session("people_inconsistent", index)
        for prompt in session.prompts:
            slipped += (prompt.plan.zones != session.user.zones(prompt.dishes)).tolist()
    assert np.mean(slipped) == pytest.approx(SLIPS, abs=0.04)


@pytest.mark.parametrize(
    ("split", "index", "salt", "sentence"),
    [
        ("people_unsene", 0, 0, "Did you mean 'people_unseen'"),
        ("people_val", 100, 0, r"has the sessions 0\.\.99, not 100"),
        ("people_val", 0, -1, "natural number"),
    ],
)
def test_what_does_not_exist_is_said(split, index, salt, sentence):
    with pytest.raises(ValueError, match=sentence):
        make_people_session(split, index, salt)

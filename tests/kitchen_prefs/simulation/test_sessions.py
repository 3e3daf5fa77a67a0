"""Sessions: pure functions of (version, split, salt, index); their splits, dishes and prompts."""

import subprocess
import sys

import pytest

from kitchen_prefs import instances
from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.preferences import CATEGORIES, TWELVE
from kitchen_prefs.simulation.sessions import (
    expert_trajectory,
    make_session,
    preference_with,
    prompt_session,
)
from kitchen_prefs.splits import SPLITS, TEST_SPLITS, get_split

SIZES = {
    "train": 560,
    "val": 70,
    "seen": 70,
    "unseen_preferences": 100,
    "unseen_counts": 210,
    "unseen_both": 150,
    "many_preferences": 200,
    "noisy": 60,
    "prompts": 600,
    "incomplete_prompts": 60,
}


def test_the_splits_have_the_sizes_of_the_design():
    assert {name: split.sessions for name, split in SPLITS.items()} == SIZES
    assert sum(SPLITS[name].sessions for name in TEST_SPLITS) == 790


def test_a_session_is_the_same_in_another_process():
    script = (
        "from kitchen_prefs.simulation.sessions import make_session\n"
        "s = make_session('many_preferences', 17, 5)\n"
        "print(s.label, s.dishes.present, s.dishes.pose.tobytes().hex())"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, check=True
    )
    session = make_session("many_preferences", 17, 5)
    dishes = session.dishes
    assert done.stdout.split() == [
        str(session.label),
        str(dishes.present),
        dishes.pose.tobytes().hex(),
    ]


def test_salts_and_splits_give_other_sessions():
    poses = {
        make_session(split, 0, salt).dishes.pose.tobytes()
        for split in ("train", "val", "seen")
        for salt in (0, 1, 2)
    }
    assert len(poses) == 9


@pytest.mark.parametrize("split", ["train", "unseen_counts", "many_preferences"])
def test_each_rack_gets_its_dishes_and_each_category_once_if_it_can(split):
    for index in range(0, SPLITS[split].sessions, 9):
        session = make_session(split, index)
        names = [CATEGORIES[c] for c in session.dishes.category]
        for rack in ("top", "bottom"):
            order = session.preference.order(rack)
            of_rack = [name for name in names if name in order]
            assert len(of_rack) == session.count
            assert len(set(of_rack)) == len(order) or session.count < len(order)
        present = session.dishes.present / len(names)
        assert 0.5 - 0.5 / len(names) <= present <= 1


@pytest.mark.parametrize("split", ["train", "prompts"])
def test_a_session_that_serves_as_a_prompt_shows_every_category_in_a_rack(split):
    for index in range(0, SPLITS[split].sessions, 20):
        session = make_session(split, index)
        racked = session.dishes.category[expert_trajectory(session).kitchen.placement >= 0]
        assert set(racked.tolist()) == set(range(len(CATEGORIES)))


@pytest.mark.parametrize("split", SPLITS)
def test_a_prompt_is_another_session_of_the_same_preference(split):
    for index in range(0, SPLITS[split].sessions, 23):
        session = make_session(split, index)
        prompt = prompt_session(session)
        assert prompt.preference == session.preference
        assert prompt.split in ("train", "prompts", "incomplete_prompts")
        alone = split == "prompts" and session.user >= len(TWELVE)
        assert alone or (prompt.split, prompt.index) != (split, index)
        other = prompt_session(session, "other")
        assert other.preference != session.preference


def test_an_incomplete_prompt_lacks_a_category_that_the_situation_has():
    for index in range(60):
        session = make_session("incomplete_prompts", index)
        in_prompt = set(prompt_session(session).dishes.category.tolist())
        assert len(in_prompt) == len(CATEGORIES) - 1
        assert set(session.dishes.category.tolist()) - in_prompt


@pytest.mark.parametrize("split", ["train", "prompts"])
def test_prompts_fit_their_capacity(split):
    longest = max(
        int((prompt_of(make_session(split, index))[:, instances.DECISION :].any(axis=1)).sum())
        for index in range(0, SPLITS[split].sessions, 10)
    )
    assert 500 < longest <= instances.PROMPT_CAPACITY


def test_labels_name_preferences():
    for index in (0, 99, 199):
        session = make_session("many_preferences", index)
        assert session.label >= len(TWELVE)
        assert preference_with(session.label) == session.preference
    assert make_session("unseen_both", 149).label == 11


def test_many_preferences_are_new_ones_and_others_for_another_salt():
    drawn = {make_session("many_preferences", i).preference for i in range(200)}
    assert len(drawn) == 200
    assert not drawn & set(TWELVE)
    assert drawn != {make_session("many_preferences", i, 1).preference for i in range(200)}


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: get_split("sean"), "Did you mean 'seen'"),
        (lambda: make_session("seen", 70), "0..69"),
        (lambda: make_session("seen", 0, -1), "natural number"),
        (lambda: preference_with(-1), "does not exist"),
    ],
)
def test_what_does_not_exist_is_named(call, words):
    with pytest.raises(ValueError, match=words):
        call()

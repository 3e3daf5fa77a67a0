"""The grammar of the data sets' names."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import kitchen_prefs
from kitchen_prefs.datasets import load_dataset, make_dataset
from kitchen_prefs.datasets.drawing import draw_dataset
from kitchen_prefs.datasets.names import content_of
from kitchen_prefs.datasets.prompt_reading import read_prompt
from kitchen_prefs.people.splits import PEOPLE_DATA_VERSION, PEOPLE_SPLITS
from kitchen_prefs.splits import DATA_VERSION, SPLITS

SMALL = "dishwasher-train-p2-d2-v1"


def test_there_is_one_data_set_a_split_and_one_with_all_twelve():
    sizes = {name: len(content_of(name).sessions) for name in kitchen_prefs.dataset_names()}
    first = {f"dishwasher-{s.name}-v{DATA_VERSION}": s.sessions for s in SPLITS.values()}
    second = {
        f"dishwasher-{s.name}-v{PEOPLE_DATA_VERSION}": s.sessions for s in PEOPLE_SPLITS.values()
    }
    assert sizes == first | second | {f"dishwasher-train-all-v{DATA_VERSION}": 12 * 80}


@given(st.integers(1, 2000))
def test_a_subset_of_users_has_the_first_ones_with_both_of_their_sessions(users):
    sessions = content_of(f"dishwasher-people_train-u{users}-v2").sessions
    assert sessions == tuple(("people_train", i) for i in range(2 * users))


def test_all_twelve_preferences_are_equally_frequent_in_train_all():
    sessions = content_of("dishwasher-train-all-v1").sessions
    users = [SPLITS[split].users[index] for split, index in sessions]
    assert np.bincount(users).tolist() == [80] * 12


@given(st.integers(1, 7), st.integers(1, 80))
def test_a_subset_has_the_first_preferences_with_the_same_number_of_demonstrations(p, d):
    sessions = content_of(f"dishwasher-train-p{p}-d{d}-v1").sessions
    assert {split for split, _ in sessions} == {"train"}
    users = [SPLITS["train"].users[index] for _, index in sessions]
    assert np.bincount(users).tolist() == [d] * p
    assert len(set(sessions)) == len(sessions)


@given(st.integers(8, 12), st.integers(1, 80))
def test_a_subset_of_prompts_has_the_first_demonstrations_of_one_held_out_preference(number, d):
    sessions = content_of(f"dishwasher-prompts-of{number}-d{d}-v1").sessions
    first = [i for i, user in enumerate(SPLITS["prompts"].users) if user == number - 1][:d]
    assert list(sessions) == [("prompts", i) for i in first]


@pytest.mark.parametrize(
    "name",
    [
        "dishwasher-train",
        "dishwasher-prompts-of7-d1-v1",
        "dishwasher-prompts-of13-d1-v1",
        "dishwasher-prompts-of8-d0-v1",
        "dishwasher-prompts-of8-d81-v1",
        "dishwasher-prompts-p1-d1-v1",
        "dishwasher-train-p8-d1-v1",
        "dishwasher-train-p0-d1-v1",
        "dishwasher-train-p1-d0-v1",
        "dishwasher-train-p1-d81-v1",
        "dishwasher-train-p01-d1-v1",
        "dishwasher-val-p1-d1-v1",
        "other/dishwasher-train-v1",
        "dishwasher-people_train-u0-v2",
        "dishwasher-people_train-u2001-v2",
        "dishwasher-people_train-u05-v2",
        "dishwasher-people_val-u5-v2",
        "../dishwasher-train-v1",
        "",
    ],
)
def test_a_name_outside_the_grammar_is_refused(name, home):
    with pytest.raises(ValueError, match="There is no data set"):
        load_dataset(name)
    assert list(home.iterdir()) == []


def test_a_misspelt_name_is_answered_with_the_nearest():
    with pytest.raises(ValueError, match="Did you mean 'dishwasher-unseen_counts-v1'"):
        content_of("dishwasher-unseen-counts-v1")


def test_another_version_is_refused_with_the_one_that_exists():
    with pytest.raises(ValueError, match="ask for 'dishwasher-train-p2-d2-v1'"):
        content_of("dishwasher-train-p2-d2-v7")
    with pytest.raises(ValueError, match="ask for 'dishwasher-people_val-v2'"):
        content_of("dishwasher-people_val-v1")


def test_a_name_may_be_lerobots_repo_id():
    assert content_of(f"kitchen_prefs/{SMALL}") == content_of(SMALL)


def test_what_the_second_tier_does_not_have_is_told(home):
    name = "dishwasher-people_train-u1-v2"
    with pytest.raises(ValueError, match="no drawings; draw a data set of the first"):
        draw_dataset(name)
    make_dataset(name)
    with pytest.raises(ValueError, match=r"is of the second tier.*give a data set of the first"):
        read_prompt(name)

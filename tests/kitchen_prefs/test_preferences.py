"""Preferences: the twelve, the space of all, and words."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kitchen_prefs.preferences import (
    CATEGORIES,
    HELD_OUT,
    RACKS,
    SEEN,
    SPACE_SIZE,
    TWELVE,
    Preference,
    preference_from_number,
    preference_number,
)


def swaps_between(one: Preference, other: Preference) -> int:
    """How many categories must change places between the racks to turn one into the other."""
    return len(set(one.top) - set(other.top))


def test_the_first_is_the_papers_first_example():
    assert TWELVE[0].first == "top"
    assert TWELVE[0].top == ("cup", "glass", "small bowl")
    assert TWELVE[0].bottom == ("big plate", "small plate", "tray", "big bowl")


def test_the_twelve_differ():
    assert len(set(TWELVE)) == 12


@pytest.mark.parametrize("category", CATEGORIES)
@pytest.mark.parametrize("rack", RACKS)
def test_no_category_is_tied_to_a_rack(category, rack):
    assert sum(preference.rack_of[category] == rack for preference in SEEN) >= 2


def test_held_out_preferences_are_far_from_the_seen_ones():
    least = [min(swaps_between(held_out, seen) for seen in SEEN) for held_out in HELD_OUT]
    assert least == [2, 2, 2, 2, 1]


@given(st.integers(0, SPACE_SIZE - 1))
def test_a_number_names_a_preference(number):
    assert preference_number(preference_from_number(number)) == number


@given(st.integers(0, SPACE_SIZE - 1), st.integers(0, SPACE_SIZE - 1))
def test_words_tell_preferences_apart(one, other):
    words = {preference_from_number(number).in_words for number in (one, other)}
    assert len(words) == len({one, other})


def test_words_read_well():
    assert TWELVE[1].in_words == (
        "Load the bottom rack with big plates, then small plates, then trays, then big bowls; "
        "then the top rack with cups, then glasses, then small bowls."
    )


@pytest.mark.parametrize("number", [-1, SPACE_SIZE])
def test_a_number_outside_the_space_is_refused(number):
    with pytest.raises(ValueError, match=f"{number} does not exist"):
        preference_from_number(number)


def test_impossible_preferences_are_refused():
    with pytest.raises(ValueError, match="first rack is 'middle'"):
        Preference("middle", TWELVE[0].top, TWELVE[0].bottom)
    with pytest.raises(ValueError, match="names each"):
        Preference("top", TWELVE[0].top, (*TWELVE[0].top, "tray"))

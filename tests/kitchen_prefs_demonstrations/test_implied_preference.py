"""Which preference a demonstration follows, if any."""

import pytest
from simulated_users import demonstrated, loading_by_rack, slipping

from kitchen_prefs.preferences import CATEGORIES, preference_from_number
from kitchen_prefs_demonstrations.implied_preference import implied_preference
from kitchen_prefs_demonstrations.kitchens import page_sessions


@pytest.mark.parametrize("number", [500, 9500])
def test_an_experts_demonstration_follows_a_preference_with_its_racks(number):
    (session,) = page_sessions(1)
    preference = preference_from_number(number)
    implied = implied_preference(demonstrated(slipping(session, preference, 0, 0), 0, 1, session))
    assert implied.is_followed
    assert implied.preference.rack_of == preference.rack_of


def test_four_categories_on_top_follow_none_of_the_preferences_which_have_three():
    (session,) = page_sessions(1)
    decisions = loading_by_rack(session, on_top=CATEGORIES[:4])
    implied = implied_preference(demonstrated(decisions, 0, 1, session))
    assert implied.elsewhere
    assert not implied.is_followed
    assert "in the other rack" in implied.why_not

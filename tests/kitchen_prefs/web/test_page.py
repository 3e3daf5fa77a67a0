"""A page in one file: whatever its data hold, they stay data, and no other script runs."""

import json

import pytest

from kitchen_prefs.web.page import self_contained_page

TEMPLATE = "$policy|$style|$script|$data"


def test_data_can_neither_close_their_element_nor_begin_another():
    data = {"name": "</script><!--<script>&amp;$script"}
    text = self_contained_page(TEMPLATE, "", "", data).split("|")[-1]
    assert not set("<>&") & set(text)
    assert json.loads(text) == data


def test_the_policy_names_this_style_and_this_script_alone():
    policy = self_contained_page(TEMPLATE, "a {}", "run()", {}).split("|")[0]
    assert policy.startswith("default-src 'none'; style-src 'sha256-")
    assert "unsafe" not in policy
    assert policy.count("sha256-") == 2


def test_numbers_that_json_does_not_have_are_refused():
    with pytest.raises(ValueError, match="JSON"):
        self_contained_page(TEMPLATE, "", "", {"mean": float("nan")})

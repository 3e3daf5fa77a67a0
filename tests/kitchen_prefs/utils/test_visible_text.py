"""Names and links as attackers have written them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kitchen_prefs.utils.visible_text import alike_key, check_public_link, check_visible


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("\u3164" * 4, "normal form"),  # Hangul fillers, which NFKC replaces by another filler
        ("\u1160" * 4, "invisible"),
        ("ttp_plus\ufe0f", "invisible"),
        ("ttp\u034f_plus", "invisible"),
        ("ttp_\u0440lus", "several scripts"),
        ("e\u0323\u0330\u0331\u0332", "normal form|stacked"),
        ("\u05d0\u05d1\u05d2 12", "right-to-left"),
        ("\u2800" * 40, "invisible"),
        ("1+cmd|' /C calc'!A0", r"character \|"),
        ("\uff54\uff54\uff50", "normal form"),
    ],
)
def test_a_name_that_shows_something_else_is_refused(name, why):
    with pytest.raises(ValueError, match=why):
        check_visible(name)


@pytest.mark.parametrize(
    "name",
    ["ttp_plus", "My TTP (v2)", "\u0141ukasz", "\u504f\u597d\u30c6\u30b9\u30c8", "\u03a9\u03bc"],
)
def test_honest_names_are_names(name):
    assert check_visible(name) == name


@given(st.text("abcXYZ012 _-.", min_size=1))
def test_what_is_plain_is_visible(name):
    assert check_visible(name) == name


def test_names_that_read_alike_have_one_key():
    assert alike_key("TTP plus") == alike_key("ttp_plus") == alike_key("ttp-pl\u00fas")
    assert alike_key("ttp_plus") != alike_key("ttp_plus2")


@pytest.mark.parametrize(
    ("name", "other"),
    [
        ("\u0422\u0422\u0420", "TTP"),  # Cyrillic
        ("\u0442\u0442\u0440", "ttp"),
        ("\u0455\u0443\u043c\u042c\u043e\u04cf\u0456\u0441", "symbolic"),
        ("\u03a4\u03a4\u03a1", "ttp"),  # Greek
        ("\u13a2\u13a2\u13e2", "TTP"),  # Cherokee
        ("\ua4d4\ua4d4\ua4d1", "TTP"),  # Lisu
        ("ttp_p1us", "ttp_plus"),
        ("ttp_pIus", "TTP PLUS"),
        ("r\u0251ndom", "random"),  # Latin letters of phonetics
        ("rnajority", "majority"),
        ("gnn_rI_32k", "gnn_rl_32K"),
        ("b0", "BO"),
    ],
)
def test_names_of_letters_that_look_alike_have_one_key(name, other):
    assert check_visible(name) == name
    assert alike_key(name) == alike_key(other)


def test_names_in_other_letters_that_look_like_no_latin_ones_stay_apart():
    names = ["\u504f\u597d", "\u504f\u884c", "\u0434\u0436", "\u0434\u0444", "\u05d0\u05d1", "dz"]
    assert len({alike_key(name) for name in names}) == len(names)


@pytest.mark.parametrize(
    "link",
    [
        "https://github.com@evil.example/",
        "http://127.0.0.1:8000/admin",
        "http://127.0.0.1/",
        "http://localhost/",
        "https://g\u0456thub.com/",
        "http://printer.local/",
        "http://[::1]/",
    ],
)
def test_a_link_to_something_else_is_refused(link):
    with pytest.raises(ValueError, match="a link names a"):
        check_public_link(link)


def test_a_link_to_a_public_page_is_a_link():
    assert check_public_link("https://example.org/a?b=c#d") == "https://example.org/a?b=c#d"

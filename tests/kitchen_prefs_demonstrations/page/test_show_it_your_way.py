"""The page in Debian's chromium: a visitor shows, TTP follows, and nothing leaves the page."""

import numpy as np
import pytest
from chromium import needs_chromium, opened
from page_visitor import centre, drawn, says, show, watch

from kitchen_prefs.preferences import SPACE_SIZE, TWELVE, preference_from_number
from kitchen_prefs_demonstrations.page.building import SALT
from kitchen_prefs_demonstrations.replaying import read_and_replay

PHONE = {"width": 390, "height": 844}
MOST_BYTES = 6_000_000  # of the page
LEAST_PACKING, LEAST_ORDER = 0.95, 0.8  # of a demonstration that is repeated
TABS = 150  # more than the page has stops

pytestmark = [
    pytest.mark.xdist_group("demonstration page"),
    pytest.mark.browser,
    pytest.mark.slow,
    needs_chromium,
]


def is_repeated(page):
    """Whether TTP, which may begin, follows what was shown."""
    packing, order = watch(page)
    return packing >= LEAST_PACKING and order >= LEAST_ORDER


def test_the_page_is_one_small_file(file):
    """Weights, three dimensions and kitchens included."""
    assert file.stat().st_size < MOST_BYTES


def test_a_demonstration_by_mouse_is_followed_and_can_be_downloaded(page, tmp_path):
    show(page, TWELVE[8], lambda instance: page.mouse.click(*centre(page, instance)))
    assert "Finished" in page.locator("#you-hint").inner_text()
    assert is_repeated(page)
    page.fill("#user", "Ada")
    page.check("#may-be-kept")
    with page.expect_download() as download:
        page.click("#downloads button")
    download.value.save_as(tmp_path / "ada.json")
    replayed = read_and_replay(tmp_path / "ada.json")
    assert replayed.decisions == page.evaluate("you.decisions")
    assert (replayed.file.user, replayed.file.consent, replayed.finished) == ("Ada", True, True)


def test_a_demonstration_by_keyboard_alone(page):
    def press(instance):
        if page.evaluate("you.decisions.length") < 8:  # until everything was chosen once by Tab
            tab_to(page, instance)
        else:
            drawn(page, instance).focus()
        page.keyboard.press("Enter")

    show(page, TWELVE[7], press)
    assert is_repeated(page)


def tab_to(page, instance):
    """Press Tab until an instance has the focus."""
    for _ in range(TABS):
        if page.evaluate("instanceOf(document.activeElement)") == instance:
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"Tab does not reach instance {instance}.")


def test_a_demonstration_by_touch_on_a_phone(browser, file):
    with opened(browser, file, viewport=PHONE, has_touch=True, is_mobile=True) as page:
        show(page, TWELVE[9], lambda instance: page.touchscreen.tap(*centre(page, instance)))
        assert is_repeated(page)
        assert page.evaluate("document.documentElement.scrollWidth") == PHONE["width"]


def test_ttp_repeats_nine_of_ten_ways_that_nobody_chose(page):
    """Ten preferences drawn from all 2 x 7!, each shown in another kitchen."""
    numbers = np.random.default_rng(17).choice(SPACE_SIZE, 10, replace=False)
    repeated = 0
    for kitchen, number in enumerate(numbers):
        preference = preference_from_number(int(number))
        page.evaluate(f"you.shown = []; startDemonstration(data.kitchens.show[{kitchen}])")
        show(page, preference)
        repeated += is_repeated(page)
    assert repeated >= 9


def test_a_second_demonstration_is_read_with_the_first(page):
    show(page, TWELVE[8])
    watch(page)
    page.click("#once-more")
    show(page, TWELVE[8])
    assert page.evaluate("ttp.shownInWords.length") == 2
    assert watch(page)[0] >= LEAST_PACKING


def test_dishes_that_were_never_shown_are_said_and_not_counted(page):
    show(page, TWELVE[8])
    watch(page)
    page.click("#never-shown")
    lacking = page.evaluate("kitchens.lacking(you.kitchen)")
    assert len(lacking) == 1
    assert "for the first time" in says(page)
    session = page.evaluate("[you.kitchen.split, you.kitchen.index, you.kitchen.salt]")
    assert session == ["incomplete_prompts", 0, SALT]
    assert page.evaluate("[you.shown.length, watchingIsOver()]") == [0, True]
    assert not page.locator("#next").is_visible()  # there is nothing that TTP could follow


def test_what_is_begun_again_after_its_end_does_not_count(page):
    show(page, TWELVE[8])
    page.click("#again")
    assert page.evaluate("[you.decisions.length, you.shown.length, ttp.timer]") == [0, 0, None]
    assert not page.locator("#keep").is_visible()
    show(page, TWELVE[9])
    assert page.evaluate("ttp.shownInWords.length") == 1


def test_each_decision_says_what_of_the_visitor_it_follows(page):
    show(page, TWELVE[8])
    page.locator("#step").click()
    assert page.locator("#by-rule").inner_text() == "opens the door first"
    page.evaluate("while (ttpState().held === null) oneDecision()")
    rule = page.locator("#by-rule").inner_text()
    assert any(words in rule for words in ("on top, ", "at the bottom, "))
    assert "not kept" not in rule
    assert not page.evaluate("follows(ttpState(), SINK, ttp.preference)")
    attention = page.locator("#by-attention").inner_text()
    assert attention.startswith("you")
    assert attention.endswith("% of its attention)")

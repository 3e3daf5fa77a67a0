"""The page as a study's instrument."""

import json

import pytest
from chromium import needs_chromium
from page_visitor import click, show

from kitchen_prefs.preferences import TWELVE
from kitchen_prefs.simulation.kitchen import DOOR, TOP_RACK

DESKTOP = {"width": 1280, "height": 900}

pytestmark = [
    pytest.mark.xdist_group("demonstration page"),
    pytest.mark.browser,
    pytest.mark.slow,
    needs_chromium,
]


def agree(page, participant, day):
    """Agree as a participant on a day."""
    page.fill("#participant", participant)
    page.select_option("#day", day)
    page.click("#consent button")


def test_a_study_asks_first_and_shows_no_policy(browser, file, tmp_path):
    page = browser.new_page(viewport=DESKTOP)
    page.goto(f"{file.as_uri()}?study=kitchen-2027")
    assert not page.locator("#stages").is_visible()
    assert "kitchen-2027" in page.locator("#consent-text").inner_text()
    assert not page.locator("#three").is_visible()
    agree(page, "p07", "2")
    assert page.evaluate("yourState().dishes.length") == 16
    assert not page.locator("#ttp").is_visible()
    assert not page.locator("#other-counter").is_visible()  # everybody loads the same kitchen
    show(page, TWELVE[8])
    assert page.locator("#again").is_disabled()
    assert "download the file" in page.locator("#you-hint").inner_text()
    with page.expect_download() as download:
        page.click("#downloads button")
    saved = json.loads(download.value.path().read_text())
    assert saved["study"] == {"name": "kitchen-2027", "participant": "p07", "day": 2}
    assert saved["user"] is None
    page.close()


def test_a_reload_loses_nothing_of_a_participant_and_shows_nothing_of_another(browser, file):
    page = browser.new_page(viewport=DESKTOP)
    page.goto(f"{file.as_uri()}?study=kitchen-2027")
    agree(page, "p07", "1")
    click(page, DOOR, TOP_RACK)
    for participant, day, decisions in (
        ("p07", "1", [DOOR, TOP_RACK]),
        ("p07", "2", []),
        ("p08", "1", []),
    ):
        page.reload()
        agree(page, participant, day)
        assert page.evaluate("you.decisions") == decisions
    page.goto(file.as_uri())
    assert page.evaluate("you.decisions") == []
    page.close()


def test_a_study_without_a_proper_name_is_a_sentence(browser, file):
    page = browser.new_page(viewport=DESKTOP)
    page.goto(f"{file.as_uri()}?study=%3Cb%3E")
    assert "1 to 60 letters" in page.locator("#trouble").inner_text()
    assert not page.locator("#stages").is_visible()
    page.close()

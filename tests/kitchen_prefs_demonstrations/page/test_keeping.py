"""What becomes of a demonstration in the page: a reload, another tab, a name, a saving program."""

import re
import threading

import pytest
from chromium import PATIENCE, needs_chromium
from page_visitor import click, show, watch
from playwright.sync_api import expect

from kitchen_prefs.preferences import TWELVE
from kitchen_prefs.simulation.kitchen import DOOR, FIRST_DISH, TOP_RACK
from kitchen_prefs_demonstrations.file_format import read_demonstration
from kitchen_prefs_demonstrations.page.building import demonstration_page
from kitchen_prefs_demonstrations.serving import SAVE_TO, DemonstrationServer

DESKTOP = {"width": 1280, "height": 900}

pytestmark = [
    pytest.mark.xdist_group("demonstration page"),
    pytest.mark.browser,
    pytest.mark.slow,
    needs_chromium,
]


def test_a_reload_loses_nothing_and_another_tab_is_another_visitor(browser, file):
    page, other = (browser.new_page(viewport=DESKTOP) for _ in range(2))
    page.goto(file.as_uri())
    click(page, DOOR, TOP_RACK, FIRST_DISH)
    page.reload()
    assert page.evaluate("you.decisions") == [DOOR, TOP_RACK, FIRST_DISH]
    other.goto(file.as_uri())
    assert other.evaluate("you.decisions") == []
    page.close()
    other.close()


def test_a_reload_of_a_second_demonstration_keeps_the_first(loose_page):
    page = loose_page
    show(page, TWELVE[8])
    watch(page)
    page.click("#once-more")
    kitchens = "[you.kitchen, ttp.kitchen].map((one) => kitchens.nameOf(one))"
    before = page.evaluate(kitchens)
    page.evaluate("youChoose(DOOR); undo()")
    page.reload()
    assert page.evaluate(kitchens) == before
    assert page.evaluate("[you.decisions.length, you.shown.length]") == [0, 1]
    page.click("#other-counter")
    assert page.evaluate(kitchens)[0] != before[0]


def test_a_reload_after_starting_again_starts_again(loose_page):
    page = loose_page
    click(page, DOOR, TOP_RACK)
    page.click("#again")
    page.reload()
    assert page.evaluate("you.decisions") == []


@pytest.mark.parametrize(
    "change", ["kept.now.kitchen = '0 prompts 1 0'", "kept.now.decisions = [BOTTOM_RACK]"]
)
def test_what_another_page_kept_does_not_break_this_one(loose_page, change):
    page = loose_page
    click(page, DOOR, TOP_RACK)
    page.evaluate(f"""() => {{
        const kept = JSON.parse(sessionStorage.getItem(storeName()));
        {change};
        sessionStorage.setItem(storeName(), JSON.stringify(kept));
    }}""")
    page.reload()
    assert page.evaluate("you.decisions") == []


def test_a_name_that_would_be_refused_is_not_downloaded(page):
    show(page, TWELVE[8])
    page.fill("#user", "<b>Ada</b>")
    page.click("#downloads button")
    assert page.locator("#kept").inner_text() == ""
    assert not page.evaluate("byId('user').checkValidity()")
    for name in ("Ada", " Anna-Lena M. ", "O\u2019Brien", ""):
        page.fill("#user", name)
        assert page.evaluate("byId('user').checkValidity()")


def test_each_of_two_demonstrations_can_be_downloaded(page):
    show(page, TWELVE[8])
    watch(page)
    page.click("#once-more")
    show(page, TWELVE[8])
    sessions = []
    for which in ("first", "second"):
        with page.expect_download() as download:
            page.click(f"text=Download {which}")
        sessions.append(read_demonstration(download.value.path()).session)
    assert len(set(sessions)) == 2


@pytest.fixture
def served(tmp_path):
    """The address of a page that saves into `tmp_path`."""
    html = demonstration_page(save_to=SAVE_TO)
    with DemonstrationServer(html, tmp_path, 0, lambda *_: None) as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.01,))
        thread.start()
        yield server.address
        server.shutdown()
        thread.join()


def test_name_and_consent_reach_the_file_that_was_saved_at_the_end(browser, served, tmp_path):
    page = browser.new_page(viewport=DESKTOP)
    page.goto(served)
    show(page, TWELVE[8])
    expect(page.locator("#kept")).to_have_text(re.compile("^Saved"), timeout=PATIENCE)
    page.fill("#user", "Ada")
    page.check("#may-be-kept")
    page.evaluate("sent")
    page.reload()
    page.evaluate("sent")
    page.close()
    (file,) = tmp_path.iterdir()
    saved = read_demonstration(file)
    assert (saved.user, saved.consent) == ("Ada", True)

"""The page in Debian's chromium: a visitor shows, TTP follows, and nothing leaves the page."""

import json

import numpy as np
import pytest
from chromium import needs_chromium, opened, running_chromium

from kitchen_prefs.preferences import CATEGORIES, SPACE_SIZE, TWELVE, preference_from_number
from kitchen_prefs.simulation.kitchen import DOOR, FIRST_DISH, RACK_INSTANCE, SINK, TOP_RACK
from kitchen_prefs_demonstrations.page.building import SALT, demonstration_page
from kitchen_prefs_demonstrations.replaying import read_and_replay

DESKTOP = {"width": 1280, "height": 900}
PHONE = {"width": 390, "height": 844}
MOST_BYTES = 6_000_000  # of the page
LEAST_PACKING, LEAST_ORDER = 0.95, 0.8  # of a demonstration that is repeated
MOST_DECISIONS = 80  # of a demonstration of 14 dishes
TABS = 150  # more than the page has stops

pytestmark = [
    pytest.mark.xdist_group("demonstration page"),
    pytest.mark.browser,
    pytest.mark.slow,
    needs_chromium,
]


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """The page."""
    out = tmp_path_factory.mktemp("page") / "show.html"
    out.write_text(demonstration_page())
    return out


@pytest.fixture(scope="module")
def browser():
    """A browser without a window."""
    with running_chromium() as chromium:
        yield chromium


@pytest.fixture
def page(browser, file):
    """The page on a desk."""
    with opened(browser, file, viewport=DESKTOP) as page:
        yield page


def next_choice(page, preference):
    """What a user of a preference chooses now, among what the page shows; None at the end."""
    state = page.evaluate("yourState()")
    if page.evaluate("isFinished(yourState())"):
        return None
    if state["held"] is not None:
        return page.evaluate("nextChoice(yourState())")  # the first free place
    names = {i: CATEGORIES[dish["category"]] for i, dish in enumerate(state["dishes"])}
    waiting = [i for i, place in enumerate(state["places"]) if place == "counter"]
    if not state["doorOpen"]:
        return DOOR
    if state["out"] is None:
        wanted = {preference.rack_of[names[i]] for i in waiting}
        return next((RACK_INSTANCE[rack] for rack in preference.racks if rack in wanted), DOOR)
    own = [i for i in waiting if preference.rack_of[names[i]] == state["out"]]
    if not own:
        return RACK_INSTANCE[state["out"]]
    return FIRST_DISH + min(own, key=lambda i: preference.rank_of[names[i]])


def show(page, preference, choose=None):
    """Give a demonstration; by default every choice is a click event."""
    choose = choose or (lambda instance: click(page, instance))
    for _ in range(MOST_DECISIONS):
        if (instance := next_choice(page, preference)) is None:
            return
        choose(instance)
    raise AssertionError("The demonstration does not end.")


def drawn(page, instance):
    """What the visitor's drawing has for an instance."""
    return page.locator(f'#you-drawing [data-instance="{instance}"]')


def centre(page, instance):
    """Where an instance can be pointed at: a rack at its name, where no dish is in the way."""
    element = drawn(page, instance)
    if instance in (1, 2):
        element = element.locator("text")
    element.scroll_into_view_if_needed()
    box = element.bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def watch(page):
    """Let TTP load its counter; packing and order by the rule that the demonstration implies."""
    page.locator("#step").click()  # pauses and takes one
    page.evaluate("while (!watchingIsOver()) oneDecision()")
    packing, order, _ = page.locator("#scores tr:first-child td").all_inner_texts()
    return float(packing), float(order)


def is_repeated(page):
    """Whether TTP, which may begin, follows what was shown."""
    packing, order = watch(page)
    return packing >= LEAST_PACKING and order >= LEAST_ORDER


def click(page, *instances):
    """Choose by click events."""
    for instance in instances:
        drawn(page, instance).dispatch_event("click")


def says(page):
    """What the page answers the visitor."""
    return page.locator("#you-says").inner_text()


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
        page.click("#download")
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


def test_a_refusal_is_a_sentence_and_changes_nothing(page):
    drawn(page, TOP_RACK).locator("text").click()
    assert says(page) == "A rack moves only with the door open."
    assert page.evaluate("you.decisions.length") == 0


def test_a_blocked_place_is_crossed_out_and_says_so(page):
    page.evaluate("[DOOR, TOP_RACK].forEach(youChoose)")
    cups = "counterDishes(yourState()).filter((i) => yourState().dishes[i].category === CUP)"
    category = page.evaluate("yourState().dishes[counterDishes(yourState())[0]].category")
    cups = cups.replace("CUP", str(category))
    page.evaluate(f"youChoose(FIRST_DISH + {cups}[0]); youChoose(nextChoice(yourState()))")
    page.evaluate("youChoose(FIRST_DISH + counterDishes(yourState())[0])")
    blocked = page.locator("#you-drawing .place.blocked")
    assert blocked.count() > 0
    assert blocked.first.get_attribute("aria-disabled") == "true"
    blocked.first.dispatch_event("click")
    assert says(page) == "The placement is blocked by a dish in the rack."
    assert page.evaluate("yourState().held !== null")


def test_the_dish_in_hand_stands_at_the_nearest_free_place_under_the_pointer(page):
    page.evaluate("[DOOR, TOP_RACK].forEach(youChoose)")
    page.evaluate("youChoose(FIRST_DISH + counterDishes(yourState())[0])")
    x, y = centre(page, page.evaluate("nextChoice(yourState())"))
    page.mouse.move(x + 2, y + 2)
    assert page.locator("#you-drawing .ghost").count() == 1
    page.mouse.move(5, 5)
    assert page.locator("#you-drawing .ghost").count() == 0


def test_undo_escape_and_starting_again(page):
    click(page, DOOR, TOP_RACK, FIRST_DISH)
    drawn(page, SINK).focus()
    page.keyboard.press("Escape")
    assert page.evaluate("yourState().held") is None
    page.click("#undo")
    assert page.evaluate("you.decisions") == [DOOR]
    page.click("#again")
    assert page.evaluate("you.decisions") == []
    before = page.evaluate("kitchens.numberOf(you.kitchen)")
    page.click("#other-counter")
    assert page.evaluate("kitchens.numberOf(you.kitchen)") != before


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


def test_a_second_demonstration_is_read_with_the_first(page):
    show(page, TWELVE[8])
    watch(page)
    page.click("#once-more")
    show(page, TWELVE[8])
    assert "2 demonstrations" in page.locator("#ttp-says").inner_text()
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


def test_each_decision_says_what_of_the_visitor_it_follows(page):
    show(page, TWELVE[8])
    page.locator("#step").click()
    assert page.locator("#by-rule").inner_text() == "opens the door first"
    page.evaluate("while (ttpState().held === null) oneDecision()")
    rule = page.locator("#by-rule").inner_text()
    assert any(words in rule for words in ("on top, ", "at the bottom, "))
    attention = page.locator("#by-attention").inner_text()
    assert attention.startswith("you")
    assert attention.endswith("% of its attention)")


def test_a_study_asks_first_and_shows_no_policy(browser, file, tmp_path):
    page = browser.new_page(viewport=DESKTOP)
    page.goto(f"{file.as_uri()}?study=kitchen-2027")
    assert not page.locator("#stages").is_visible()
    assert "kitchen-2027" in page.locator("#consent-text").inner_text()
    page.fill("#participant", "p07")
    page.select_option("#day", "2")
    page.click("#consent button")
    assert page.evaluate("yourState().dishes.length") == 16
    assert not page.locator("#ttp").is_visible()
    page.evaluate("[DOOR, TOP_RACK, FIRST_DISH, nextChoice.length].slice(0, 3).forEach(youChoose)")
    page.evaluate("youChoose(nextChoice(yourState())); finishDemonstration()")
    with page.expect_download() as download:
        page.click("#download")
    saved = json.loads(download.value.path().read_text())
    assert saved["study"] == {"name": "kitchen-2027", "participant": "p07", "day": 2}
    assert saved["user"] is None
    page.close()


def test_a_study_without_a_proper_name_is_a_sentence(browser, file):
    page = browser.new_page(viewport=DESKTOP)
    page.goto(f"{file.as_uri()}?study=%3Cb%3E")
    assert "1 to 60 letters" in page.locator("#trouble").inner_text()
    assert not page.locator("#stages").is_visible()
    page.close()

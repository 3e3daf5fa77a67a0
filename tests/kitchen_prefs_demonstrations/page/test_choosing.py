"""The page's kitchen as something to act on: choices, refusals, what is taken back."""

import pytest
from chromium import needs_chromium
from page_visitor import centre, click, drawn, says, show

from kitchen_prefs.envs.kitchen_env import MAX_EPISODE_STEPS
from kitchen_prefs.preferences import TWELVE
from kitchen_prefs.simulation.kitchen import DOOR, FIRST_DISH, SINK, TOP_RACK

pytestmark = [
    pytest.mark.xdist_group("demonstration page"),
    pytest.mark.browser,
    pytest.mark.slow,
    needs_chromium,
]


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


def test_every_place_has_a_name_of_its_own(page):
    page.evaluate("[DOOR, TOP_RACK].forEach(youChoose)")
    page.evaluate("youChoose(FIRST_DISH + counterDishes(yourState())[0])")
    names = page.evaluate("choicesIn(yourState()).map((one) => nameOf(yourState(), one))")
    assert len(set(names)) == len(names) > 10
    assert "free place, front left of the top rack, 1 of " in " ".join(names)


def test_a_refusal_that_is_said_again_is_another_text_for_a_screen_reader(page):
    texts = []
    for _ in range(2):
        click(page, SINK)
        texts.append(page.locator("#you-says").text_content())
    assert texts[0] != texts[1]
    assert texts[0] == texts[1].strip()


def test_the_dish_in_hand_stands_at_the_nearest_free_place_under_the_pointer(page):
    page.evaluate("[DOOR, TOP_RACK].forEach(youChoose)")
    page.evaluate("youChoose(FIRST_DISH + counterDishes(yourState())[0])")
    x, y = centre(page, page.evaluate("nextChoice(yourState())"))
    page.mouse.move(x + 2, y + 2)
    assert page.locator("#you-drawing .ghost").count() == 1
    page.mouse.move(5, 5)
    assert page.locator("#you-drawing .ghost").count() == 0


def test_the_sink_without_a_dish_in_hand_is_a_refusal(page):
    click(page, SINK)
    assert says(page).startswith("Only a dish on the counter can be picked")
    assert page.evaluate("you.decisions.length") == 0


def test_no_more_is_shown_than_a_prompt_holds(page):
    page.evaluate(f"for (let i = 0; i < {MAX_EPISODE_STEPS}; i += 1) youChoose(DOOR)")
    rows = page.evaluate("rowsRead(you.steps.slice(0, -1))")
    assert rows <= page.evaluate("data.most.rows")
    assert "more than a policy reads" in says(page)
    page.evaluate("while (you.decisions.length) undo()")
    click(page, DOOR)
    assert says(page) == "Opens the door"


def test_a_key_that_is_held_down_is_one_choice(page):
    drawn(page, DOOR).focus()
    page.keyboard.down("Enter")
    page.keyboard.down("Enter")
    page.keyboard.up("Enter")
    assert page.evaluate("you.decisions") == [DOOR]


def test_undo_escape_and_starting_again(page):
    click(page, DOOR, TOP_RACK, FIRST_DISH)
    drawn(page, SINK).focus()
    page.keyboard.press("Escape")
    assert page.evaluate("yourState().held") is None
    page.click("#undo")
    assert page.evaluate("you.decisions") == [DOOR]
    page.click("#again")
    assert page.evaluate("you.decisions") == []
    before = page.evaluate("kitchens.nameOf(you.kitchen)")
    page.click("#other-counter")
    assert page.evaluate("kitchens.nameOf(you.kitchen)") != before


def test_undo_by_keyboard_keeps_the_focus(page):
    click(page, DOOR)
    page.focus("#undo")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "you"


def test_u_takes_back_in_three_dimensions_and_is_a_letter_in_a_name(loose_page):
    page = loose_page
    page.click("#three")
    page.evaluate("[DOOR, TOP_RACK].forEach(youChoose)")
    page.focus("#again")
    page.keyboard.press("u")
    assert page.evaluate("you.decisions") == [DOOR]
    page.click("#three")
    show(page, TWELVE[8])
    page.click("#user")
    page.keyboard.type("Uu")
    assert page.input_value("#user") == "Uu"


def test_who_finishes_by_keyboard_can_go_on_by_keyboard(page):
    show(page, TWELVE[8])
    page.focus("#step")
    page.evaluate("while (!watchingIsOver()) oneDecision()")
    assert page.evaluate("document.activeElement.id") == "ttp-other"
    assert "TTP has finished" in page.locator("#ttp-ends").inner_text()
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.id") == "play"


def test_a_click_on_a_dish_in_a_rack_moves_the_rack(page):
    click(page, DOOR, TOP_RACK)
    page.evaluate("youChoose(FIRST_DISH + counterDishes(yourState())[0])")
    page.evaluate("youChoose(nextChoice(yourState()))")
    page.locator('#you-drawing .dish[data-place="top"]').first.dispatch_event("click")
    assert page.evaluate("yourState().out") is None

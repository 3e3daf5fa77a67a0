"""A visitor of the page "Show it your way", who chooses by a preference."""

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.kitchen import DOOR, FIRST_DISH, RACK_INSTANCE

MOST_DECISIONS = 80  # of a demonstration of 16 dishes


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


def click(page, *instances):
    """Choose by click events."""
    for instance in instances:
        drawn(page, instance).dispatch_event("click")


def says(page):
    """What the page answers the visitor."""
    return page.locator("#you-says").inner_text().strip()

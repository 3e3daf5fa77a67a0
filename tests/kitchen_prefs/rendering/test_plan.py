"""Plans: what is where, and what the decision chooses, as colours in the picture."""

import numpy as np
import pytest
from PIL import ImageColor

from kitchen_prefs.people.attributes import MATERIALS
from kitchen_prefs.people.sessions import make_people_session, people_table
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.canvas import Canvas
from kitchen_prefs.rendering.plan import RING, draw_plan, in_words
from kitchen_prefs.rendering.plan_dishes import GLAZES, draw_dish
from kitchen_prefs.rendering.plan_ground import (
    CARD,
    COUNTER,
    DOOR_BOX,
    RACK_AREAS,
    SHADE,
    SINK,
    WOOD,
    Area,
)
from kitchen_prefs.rendering.plan_lists import UPRIGHT
from kitchen_prefs.rendering.state import Look
from kitchen_prefs.simulation import kitchen as numbers
from kitchen_prefs.simulation.kitchen import Kitchen, placement_table
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session

SESSION = make_session("val", 3)
DECISIONS = expert_trajectory(SESSION).decisions


def kitchen_before(decision):
    kitchen = Kitchen(SESSION.dishes)
    for instance in DECISIONS[:decision]:
        assert kitchen.decide(instance) == ""
    return kitchen


def plan_of(decision, kitchen=None):
    kitchen = kitchen or kitchen_before(decision)
    return draw_plan(
        kitchen, SESSION.preference, DECISIONS[decision], decision, len(DECISIONS)
    ).astype(int)


def first(chosen):
    """The first decision that chooses such an instance."""
    return next(i for i, instance in enumerate(DECISIONS) if chosen(instance))


def alike(picture, colour):
    """Which pixels are nearly of a colour, (H, W) bool."""
    return np.abs(picture - ImageColor.getrgb(colour)).max(-1) < 12


def around(place, radius=24):
    x, y = np.round(place).astype(int)
    return slice(max(y - radius, 0), y + radius), slice(max(x - radius, 0), x + radius)


def test_a_picked_dish_has_a_ring_and_no_other_dish_has():
    decision = first(lambda i: numbers.FIRST_DISH <= i < numbers.SINK)
    kitchen, ring = kitchen_before(decision), alike(plan_of(decision), RING)
    picked = DECISIONS[decision] - numbers.FIRST_DISH
    places = COUNTER.place(kitchen.pose[kitchen.counter, :2])
    nearest = {}
    for y, x in np.argwhere(ring):
        dish = int(kitchen.counter[np.hypot(*(places - (x, y)).T).argmin()])
        nearest[dish] = nearest.get(dish, 0) + 1
    assert nearest[picked] / ring.sum() > 0.9


@pytest.mark.parametrize(
    ("chosen", "box"),
    [
        (numbers.DOOR, DOOR_BOX),
        (numbers.TOP_RACK, RACK_AREAS["top"].box),
        (numbers.BOTTOM_RACK, RACK_AREAS["bottom"].box),
    ],
)
def test_the_door_or_rack_that_moves_has_a_ring(chosen, box):
    ring = np.argwhere(alike(plan_of(first(lambda i: i == chosen)), RING))
    low, high = ring.min(0)[::-1], ring.max(0)[::-1]
    np.testing.assert_allclose([*low, *high], box, atol=8)


def test_a_dish_moves_from_the_counter_to_the_ringed_place_in_its_colour():
    decision = first(lambda i: i >= numbers.FIRST_PLACEMENT["bottom"])
    kitchen = kitchen_before(decision)
    category = CATEGORIES[kitchen.dishes.category[kitchen.held]]
    spot = around(COUNTER.place(kitchen.pose[kitchen.held, :2]), radius=5)
    rack = kitchen.open_rack
    pose = placement_table().pose[rack][DECISIONS[decision] - numbers.FIRST_PLACEMENT[rack]]
    place = around(RACK_AREAS[rack].place(pose[:2]), radius=40)
    before, after = plan_of(decision), plan_of(decision + 1)
    assert alike(before[place], RING).any()
    assert not alike(before[place], GLAZES[category]).any()
    assert alike(after[place], GLAZES[category]).sum() > 100
    assert not alike(before[spot], WOOD).any()
    assert alike(after[spot], WOOD).all()


def test_an_arrow_leads_into_the_sink_and_its_dishes_are_counted():
    kitchen = kitchen_before(first(lambda i: i >= numbers.FIRST_PLACEMENT["bottom"]))
    picture = draw_plan(kitchen, SESSION.preference, numbers.SINK, 0, 1).astype(int)
    left, top, right, bottom = (round(side) for side in SINK.box)
    assert alike(picture[top : bottom + 5, left:right], RING).sum() > 200
    assert in_words(kitchen, numbers.SINK).endswith("into the sink")
    basin = picture[top + 8 : bottom - 8, left + 8 : right - 8]
    kitchen.decide(numbers.SINK)
    after = draw_plan(kitchen, SESSION.preference, numbers.DOOR, 0, 1).astype(int)
    assert (after[top + 8 : bottom - 8, left + 8 : right - 8] != basin).any()


def test_a_rack_that_is_out_is_white_and_one_that_is_in_is_pale():
    decision = first(lambda i: i == numbers.TOP_RACK) + 1
    picture = plan_of(decision)
    for rack, colour in (("top", CARD), ("bottom", SHADE)):
        left, top, right, bottom = (round(side) for side in RACK_AREAS[rack].box)
        assert alike(picture[top + 5 : bottom - 5, left + 5 : right - 5], colour).mean() > 0.7


def test_the_words_tell_the_whole_demonstration():
    kitchen, told = Kitchen(SESSION.dishes), []
    for instance in DECISIONS:
        told.append(in_words(kitchen, instance))
        kitchen.decide(instance)
    assert told[0] == "opens the door"
    assert told[1] == f"pulls the {SESSION.preference.first} rack out"
    assert told[-1] == "closes the door"
    picks = [words for words in told if words.startswith("picks")]
    assert len(picks) == len(SESSION.dishes.category)
    assert told[2] == f"picks a {SESSION.preference.order(SESSION.preference.first)[0]}"


def dish_of(look):
    """A bowl of the second tier on white ground, (80, 80, 3) int."""
    canvas = Canvas(80, 80, "white")
    draw_dish(canvas, Area((0.0, 0.0), (0.0, 0.0), (40, 40), 360), "small bowl", UPRIGHT, look)
    return canvas.picture().astype(int)


def test_bowls_of_the_second_tier_differ_by_material_colour_soil_and_size():
    looks = [
        *(Look(material, "blue") for material in MATERIALS),
        *(Look("plastic", colour) for colour in ("white", "red", "green")),
        Look("plastic", "blue", greasy=True),
        Look("plastic", "blue", scale=0.85),
    ]
    drawn = [dish_of(look) for look in looks]
    for first in range(len(looks)):
        for second in range(first):
            different = np.abs(drawn[first] - drawn[second]).max(axis=-1) > 30
            assert different.mean() > 0.03, (looks[first], looks[second])


def test_a_plan_of_the_second_tier_has_a_legend_instead_of_an_order():
    session = make_people_session("people_overflow", 0)
    kitchen = Kitchen(session.dishes, people_table())
    decisions = session.expert.trajectory.decisions
    decision = next(i for i, one in enumerate(decisions) if one > numbers.SINK)
    for instance in decisions[:decision]:
        kitchen.decide(instance)
    instance = decisions[decision]
    picture = draw_plan(kitchen, None, instance, decision, len(decisions)).astype(int)
    rack = "top" if instance >= numbers.FIRST_PLACEMENT["top"] else "bottom"
    pose = people_table().pose[rack][instance - numbers.FIRST_PLACEMENT[rack]]
    assert alike(picture[around(RACK_AREAS[rack].place(pose[:2]), radius=60)], RING).any()
    left = round(RACK_AREAS["bottom"].box[2])
    assert alike(picture[:, left:], "#452410").sum() > 20  # stains of the legend's greasy dish

"""What a picture shows of a kitchen."""

import numpy as np
import pytest

from kitchen_prefs.people.attributes import COLOURS, MATERIALS
from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.rendering.state import rack_scene, scene_of, sink_scene
from kitchen_prefs.simulation.kitchen import Kitchen, Location
from kitchen_prefs.simulation.sessions import make_session

SESSION = make_people_session("people_overflow", 0)
LOADED = SESSION.expert.trajectory.kitchen


def test_dishes_of_the_second_tier_bring_their_look_and_those_of_the_first_do_not():
    dishes = SESSION.dishes
    for number, shown in enumerate(scene_of(LOADED).dishes):
        assert shown.look.material == MATERIALS[dishes.material[number]]
        assert shown.look.colour == tuple(COLOURS)[dishes.colour[number]]
        assert shown.look.greasy == dishes.greasy[number]
        assert shown.look.scale == pytest.approx(dishes.scale[number])
    first_tier = scene_of(Kitchen(make_session("val", 0).dishes))
    assert {shown.look for shown in first_tier.dishes} == {None}


def test_racks_and_sink_together_show_every_dish_once():
    top, bottom, sink = rack_scene(LOADED, "top"), rack_scene(LOADED, "bottom"), sink_scene(LOADED)
    counts = [len(scene.dishes) for scene in (bottom, top, sink)]
    places = (Location.BOTTOM, Location.TOP, Location.SINK)
    assert counts == [(LOADED.location == place).sum() for place in places]
    assert sum(counts) == len(SESSION.dishes.category)
    assert (top.door_open, top.top_out, top.bottom_out) == (True, True, False)
    assert (bottom.door_open, bottom.top_out, bottom.bottom_out) == (True, False, True)
    assert np.ptp([dish.position[2] for dish in top.dishes]) < 0.3

"""The expert of the second tier: from any reachable state it finishes, and it keeps its plan."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from kitchen_prefs.people.attributes import draw_dishes
from kitchen_prefs.people.expert import PlanExpert, roll_out_plan
from kitchen_prefs.people.user_sampling import sample_user
from kitchen_prefs.people.zones import (
    OVERFLOW_INDEX,
    SINK_ZONE,
    free_zones,
    targets_now,
    zone_of_placements,
)
from kitchen_prefs.simulation.kitchen import (
    FIRST_DISH,
    FIRST_PLACEMENT,
    SINK,
    Kitchen,
    Location,
)

seeds = st.integers(0, 10**6)


def drawn(seed, count=16):
    generator = np.random.default_rng(seed)
    dishes = draw_dishes(count, generator)
    return Kitchen(dishes), sample_user(generator), generator


def wander(kitchen, generator, decisions):
    """Take random decisions that the kitchen carries out."""
    choices = [*range(FIRST_DISH + len(kitchen.location)), SINK]
    for _ in range(decisions):
        more = [
            FIRST_PLACEMENT[kitchen.open_rack] + int(p)
            for p in kitchen.placements()
            if kitchen.open_rack
        ]
        possible = [one for one in choices + more if not kitchen.refusal(one)]
        kitchen.decide(int(generator.choice(possible)))


@given(seeds, st.integers(0, 40))
def test_it_finishes_from_any_reachable_state(seed, decisions):
    kitchen, user, generator = drawn(seed)
    wander(kitchen, generator, decisions)
    plan = user.plan(kitchen.dishes)
    if not kitchen.finished:
        assert roll_out_plan(kitchen, plan).kitchen.finished


@given(seeds)
def test_every_dish_goes_to_the_first_zone_of_its_list_that_is_free(seed):
    kitchen, user, _ = drawn(seed, count=18)
    plan = user.plan(kitchen.dishes)
    zone = zone_of_placements(kitchen.table)
    expert = PlanExpert(kitchen, plan)
    while not kitchen.finished:
        instance, held = expert.choose(), kitchen.held
        if held is not None:
            targets = targets_now(kitchen)[OVERFLOW_INDEX[plan.overflow]]
            wanted = targets[kitchen.dishes.category[held], plan.zones[held]]
            if instance == SINK:
                assert wanted == SINK_ZONE
            else:
                rack = kitchen.open_rack
                assert zone[rack][instance - FIRST_PLACEMENT[rack]] == wanted
                assert free_zones(kitchen)[kitchen.dishes.category[held], wanted]
        assert not kitchen.decide(instance)
    by_hand = plan.zones == SINK_ZONE
    assert (kitchen.location[by_hand] == Location.SINK).all()


def test_it_decides_the_same_again():
    for seed in range(5):
        (one, user, _), (other, _, _) = drawn(seed), drawn(seed)
        plan = user.plan(one.dishes)
        assert roll_out_plan(one, plan).decisions == roll_out_plan(other, plan).decisions

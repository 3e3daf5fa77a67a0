"""What the plan reader sees of demonstrations and kitchens is what happened there."""

import numpy as np
import pytest
import torch

from kitchen_prefs.envs.people_demonstrations import people_prompt_of
from kitchen_prefs.envs.people_environment import DishwasherPeople
from kitchen_prefs.people.expert import ends_of
from kitchen_prefs.people.sessions import make_people_session, people_table
from kitchen_prefs.simulation.kitchen import FIRST_DISH, SINK, Kitchen
from lerobot_policy_kitchen_prefs.ttp_plan.dish_tokens import (
    CATEGORIES,
    CATEGORY_PART,
    placed_dishes,
)
from lerobot_policy_kitchen_prefs.ttp_plan.rack_state import ContentsMemory, open_racks

ZONES = 4


@pytest.fixture(scope="module", params=range(4))
def shown(request):
    return make_people_session("people_train", request.param).prompts[0]


def test_a_prompt_tells_what_each_dish_is_and_where_and_when_it_was_put(shown):
    read = placed_dishes(torch.tensor(people_prompt_of(shown))[None])
    picked = [one - FIRST_DISH for one in shown.trajectory.decisions if FIRST_DISH <= one < SINK]
    real = read.mask[0].numpy()
    assert real.sum() == len(picked) == len(shown.dishes.category)
    category = read.attributes[0, real, CATEGORY_PART].argmax(dim=-1)
    assert category.tolist() == shown.dishes.category[picked].tolist()
    assert read.zones[0, real].tolist() == ends_of(shown.trajectory.kitchen)[picked].tolist()
    assert read.arrivals[0, real].tolist() == first_seen(shown)[picked].tolist()
    decisions = read.decisions[0, real].int().tolist()
    assert [shown.trajectory.decisions[k] for k in decisions] == [FIRST_DISH + d for d in picked]


def test_contents_are_what_stood_in_the_zones(shown):
    read = placed_dishes(torch.tensor(people_prompt_of(shown))[None])
    kitchen = Kitchen(shown.dishes, people_table())
    for number, decision in enumerate(shown.trajectory.decisions):
        stands = read.contents_at(torch.tensor([float(number)]))[0]
        assert stands.int().tolist() == contents_of(kitchen).tolist()
        kitchen.decide(decision)


def test_what_a_closed_rack_hides_is_remembered():
    environment = DishwasherPeople("people_train")
    observation, _ = environment.reset(options={"session": 3})
    memory, ended = ContentsMemory(), False
    while not ended:
        sets = torch.from_numpy(observation["instances"])[None]
        kitchen = environment.simulator.kitchen
        assert memory.update(sets)[0].int().tolist() == contents_of(kitchen).tolist()
        assert open_racks(sets)[0].tolist() == [kitchen.open_rack == r for r in ("top", "bottom")]
        observation, *_, ended, _, _ = environment.step(environment.simulator.expert_action())


def test_the_dishes_of_several_demonstrations_keep_apart():
    prompts = [make_people_session("people_train", i).prompts[0] for i in range(2)]
    rows = torch.from_numpy(np.stack([people_prompt_of(one) for one in prompts]))
    joined = placed_dishes(rows).joined(2)
    together, half = joined.together()[0], joined.mask.shape[1] // 2
    assert together.any()
    assert not together[:half, half:].any()
    assert not joined.preferred()[0, half:, :half].any()


def contents_of(kitchen):
    """How many dishes of each category stand in each zone, (4, 7)."""
    zones, contents = ends_of(kitchen), np.zeros((ZONES, CATEGORIES), dtype=int)
    racked = zones < ZONES
    np.add.at(contents, (zones[racked], kitchen.dishes.category[racked]), 1)
    return contents


def first_seen(shown):
    """The decision at which each dish is first visible, (n,)."""
    kitchen = Kitchen(shown.dishes, people_table())
    seen = np.full(len(shown.dishes.category), -1)
    for number, decision in enumerate(shown.trajectory.decisions):
        waiting = kitchen.counter
        seen[waiting] = np.where(seen[waiting] < 0, number, seen[waiting])
        kitchen.decide(decision)
    return seen

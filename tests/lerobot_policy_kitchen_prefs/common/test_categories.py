"""Categories: dishes and places have one, the door and the racks have none."""

import torch

from kitchen_prefs.instances import EXTENTS, is_real

FIXTURES = 3  # the door and two racks


def test_all_dishes_and_places_have_a_category_and_nothing_else_has(pairs, categories):
    category, is_dish = categories.find(pairs.sets)  # (S, N)
    assert len(categories) == 7
    assert torch.equal(categories.extents[category[is_dish]], pairs.sets[is_dish][:, EXTENTS])
    assert ((is_real(pairs.sets) & ~is_dish).sum(dim=1) == FIXTURES).all()
    assert not (is_dish & ~is_real(pairs.sets)).any()

"""Categories: dishes and places have one, the door and the racks have none."""

import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs.envs.observations import EXTENT_NOISE
from kitchen_prefs.instances import EXTENTS, is_real
from lerobot_policy_kitchen_prefs.common.categories import nearest_category, nearest_noisy_category

FIXTURES = 3  # the door and two racks


def test_all_dishes_and_places_have_a_category_and_nothing_else_has(pairs, categories):
    category, is_dish = categories.find(pairs.sets)  # (S, N)
    assert len(categories) == 7
    assert torch.equal(categories.extents[category[is_dish]], pairs.sets[is_dish][:, EXTENTS])
    assert ((is_real(pairs.sets) & ~is_dish).sum(dim=1) == FIXTURES).all()
    assert not (is_dish & ~is_real(pairs.sets)).any()


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_noisy_dishes_keep_their_category(pairs, categories, seed):
    category, is_dish = categories.find(pairs.sets)
    noise = torch.randn((*pairs.sets.shape[:2], 3), generator=torch.Generator().manual_seed(seed))
    noisy = pairs.sets.clone()
    noisy[..., EXTENTS] *= 1 + EXTENT_NOISE * noise
    nearest = nearest_category(noisy, categories.extents)
    nearest_noisy, _ = nearest_noisy_category(noisy, categories.extents)
    assert (nearest == category)[is_dish].float().mean() > 0.99
    assert (nearest_noisy == category)[is_dish].float().mean() > 0.999


def test_arrays_and_tensors_have_the_same_categories(pairs, categories):
    of_tensors = nearest_category(pairs.sets, categories.extents)
    of_arrays = nearest_category(pairs.sets.numpy(), categories.extents.numpy())
    assert of_tensors.tolist() == of_arrays.tolist()

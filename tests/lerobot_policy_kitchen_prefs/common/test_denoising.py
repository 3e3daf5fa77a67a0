"""What is seen noisily is taken for what is known."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs.envs.observations import EXTENT_NOISE, POSITION_NOISE
from kitchen_prefs.instances import EXTENTS, IS_OBJECT, POSE, POSITION
from lerobot_policy_kitchen_prefs.common import denoising as recognising
from lerobot_policy_kitchen_prefs.common.denoising import Denoiser
from lerobot_policy_kitchen_prefs.ttp.rack_poses import find_racks

SEEDS = st.integers(0, 10_000)


@pytest.fixture(scope="module")
def recognition(demonstrations):
    recognition = Denoiser()
    recognition.remember(demonstrations)
    return recognition


def seen_noisily(sets, generator):
    """The sets with the errors of the split `noisy`, about dishes and the one in the hand."""
    is_dish = sets[..., IS_OBJECT] > 0
    of_extents, of_position = torch.from_numpy(
        generator.standard_normal((2, *sets.shape[:2], 3), dtype=np.float32)
    )
    of_extents = of_extents.where(is_dish[..., None], of_extents[:, :1])
    sets = sets.clone()
    sets[..., EXTENTS] *= 1 + EXTENT_NOISE * of_extents
    sets[..., POSITION] += POSITION_NOISE * of_position * is_dish[..., None]
    return sets


def test_what_is_seen_exactly_is_recognised_as_it_is(pairs, recognition):
    assert torch.equal(recognition(pairs.sets), pairs.sets)


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_noisy_dishes_are_recognised(pairs, categories, recognition, seed):
    noisy = seen_noisily(pairs.sets, np.random.default_rng(seed))
    recognised = recognition(noisy)
    is_dish = categories.find(pairs.sets)[1]  # (S, N)
    right = (recognised[..., EXTENTS] == pairs.sets[..., EXTENTS]).all(dim=-1)
    assert right[is_dish].float().mean() > 0.999
    in_rack = is_dish & find_racks(pairs.sets)[1]
    right = (recognised[..., POSE] == pairs.sets[..., POSE]).all(dim=-1)
    assert right[in_rack].float().mean() > 0.999
    on_counter = is_dish & ~in_rack
    assert torch.equal(recognised[on_counter][:, POSE], noisy[on_counter][:, POSE])


def test_what_is_unknown_is_left_as_it_is(pairs, recognition):
    larger = pairs.sets.clone()
    larger[..., EXTENTS] *= 3
    assert torch.equal(recognition(larger), larger)


def test_without_a_memory_nothing_is_recognised(pairs):
    assert torch.equal(Denoiser()(pairs.sets), pairs.sets)


def test_a_memory_that_is_too_small_is_named(demonstrations, monkeypatch):
    monkeypatch.setattr(recognising, "CAPACITY", 5)
    with pytest.raises(ValueError, match=r"show \d+ places, and 5 can be remembered"):
        Denoiser().remember(demonstrations)

"""Denoising: noisy observations are snapped to known extents and poses."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs.envs.observations import EXTENT_NOISE, POSITION_NOISE
from kitchen_prefs.instances import EXTENTS, IS_OBJECT, POSE, POSITION
from lerobot_policy_kitchen_prefs.common import denoising
from lerobot_policy_kitchen_prefs.common.denoising import Denoiser
from lerobot_policy_kitchen_prefs.common.dish_locations import in_rack

pytestmark = pytest.mark.xdist_group("denoising")  # one fixture of the module serves all

SEEDS = st.integers(0, 10_000)


@pytest.fixture(scope="module")
def denoiser(demonstrations):
    denoiser = Denoiser()
    denoiser.fit(demonstrations)
    return denoiser


def with_noise(sets, generator):
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


def test_exact_observations_stay_as_they_are(pairs, denoiser):
    assert torch.equal(denoiser(pairs.sets), pairs.sets)


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_noisy_dishes_are_denoised(pairs, categories, denoiser, seed):
    noisy = with_noise(pairs.sets, np.random.default_rng(seed))
    denoised = denoiser(noisy)
    is_dish = categories.find(pairs.sets)[1]  # (S, N)
    right = (denoised[..., EXTENTS] == pairs.sets[..., EXTENTS]).all(dim=-1)
    assert right[is_dish].float().mean() > 0.999
    racked = is_dish & in_rack(pairs.sets)
    right = (denoised[..., POSE] == pairs.sets[..., POSE]).all(dim=-1)
    assert right[racked].float().mean() > 0.999
    on_counter = is_dish & ~racked
    assert torch.equal(denoised[on_counter][:, POSE], noisy[on_counter][:, POSE])


def test_unknown_sizes_stay_as_they_are(pairs, denoiser):
    larger = pairs.sets.clone()
    larger[..., EXTENTS] *= 3
    assert torch.equal(denoiser(larger), larger)


def test_without_known_places_nothing_changes(pairs):
    assert torch.equal(Denoiser()(pairs.sets), pairs.sets)


def test_too_many_places_are_refused(demonstrations, monkeypatch):
    monkeypatch.setattr(denoising, "CAPACITY", 5)
    with pytest.raises(ValueError, match=r"show \d+ places, and 5 can be stored"):
        Denoiser().fit(demonstrations)

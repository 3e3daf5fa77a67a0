"""Clashes: what the judgement of pairs may depend on, and the geometry that it is given."""

import numpy as np
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from kitchen_prefs.instances import (
    COLUMNS,
    EXTENTS,
    IS_OBJECT,
    IS_PLACE,
    POSITION,
    QUATERNION,
)
from lerobot_policy_kitchen_prefs.ttp.clashes import UNIT, Clashes, pair_features, rotation

GAP = 6  # the column of the largest gap
SEEDS = st.integers(0, 10_000)
CLOSE = {"atol": 1e-4, "rtol": 1e-4}


def judge(sets):
    """The penalties of an untrained network, the same one each time."""
    torch.manual_seed(0)
    return Clashes()(sets)


def test_only_places_are_penalised(place_sets):
    penalties = judge(place_sets)
    is_place = place_sets[..., IS_PLACE] > 0
    assert (penalties[is_place] >= 0).all()
    assert (penalties[is_place] > 0).any()
    assert not penalties[~is_place].any()


def test_a_pick_decision_has_no_penalties(pairs):
    is_pick = ~(pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    assert not judge(pairs.sets[is_pick]).any()


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_penalties_follow_their_rows(place_sets, seed):
    order = torch.from_numpy(np.random.default_rng(seed).permutation(place_sets.shape[1]))
    assert torch.allclose(judge(place_sets[:, order]), judge(place_sets)[:, order], **CLOSE)


@settings(max_examples=10, deadline=None)
@given(shift=st.tuples(*[st.floats(-1, 1, width=32)] * 3))
def test_a_rack_elsewhere_has_the_same_penalties(place_sets, shift):
    shifted = place_sets.clone()
    is_real = (place_sets != 0).any(dim=-1, keepdim=True)
    shifted[..., POSITION] += torch.tensor(shift) * is_real
    assert torch.allclose(judge(shifted), judge(place_sets), **CLOSE)


def with_an_object(sets, position):
    """The sets with one more object, of the size of the first place, (B, N + 1, 13)."""
    first_place = (sets[..., IS_PLACE] > 0).int().argmax(dim=1)
    added = sets[torch.arange(len(sets)), first_place].clone()  # (B, 13)
    added[:, POSITION] += torch.tensor(position)
    added[:, IS_PLACE], added[:, IS_OBJECT] = 0, 1
    return torch.cat([sets, added[:, None]], dim=1)


def test_a_near_object_changes_the_penalties_and_a_far_one_does_not(place_sets):
    before = judge(place_sets)
    far = judge(with_an_object(place_sets, (0.0, 0.0, 2.0)))[:, :-1]
    near = judge(with_an_object(place_sets, (0.0, 0.0, 0.0)))[:, :-1]
    assert torch.allclose(far, before, **CLOSE)
    assert (near >= before - 1e-4).all()
    assert (near > before + 1e-2).any(dim=1).all()


def random_rows(generator, number):
    """Instances of the sizes of dishes, turned at random, within half a metre, (number, 13)."""
    rows = np.zeros((number, COLUMNS))
    rows[:, EXTENTS] = generator.uniform(0.02, 0.3, (number, 3))
    rows[:, POSITION] = generator.uniform(-0.25, 0.25, (number, 3))
    rows[:, QUATERNION] = Rotation.random(number, rng=generator).as_quat(scalar_first=True)
    return torch.from_numpy(rows)


@given(seed=SEEDS)
def test_rotation_matrices_are_scipy_s(seed):
    quaternions = Rotation.random(20, rng=seed).as_quat(scalar_first=True)
    expected = Rotation.from_quat(quaternions, scalar_first=True).as_matrix()
    assert np.allclose(rotation(torch.from_numpy(quaternions)).numpy(), expected)


@given(seed=SEEDS)
def test_one_in_the_other_s_place_leaves_no_gap(seed):
    places, objects = random_rows(np.random.default_rng(seed), 40).split(20)
    objects[:, POSITION] = places[:, POSITION]
    assert (pair_features(places, objects)[:, GAP] < 0).all()


@given(seed=SEEDS)
def test_two_that_cannot_touch_have_a_gap(seed):
    generator = np.random.default_rng(seed)
    places, objects = random_rows(generator, 40).split(20)
    reach = (places[:, EXTENTS].norm(dim=1) + objects[:, EXTENTS].norm(dim=1)) / 2
    direction = torch.from_numpy(generator.standard_normal((20, 3)))
    direction /= direction.norm(dim=1, keepdim=True)
    objects[:, POSITION] = places[:, POSITION] + 1.01 * reach[:, None] * direction
    assert (pair_features(places, objects)[:, GAP] > 0).all()


def surface(rows, generator):
    """Points on the rims of the elliptical cylinders, in world coordinates, (K, 200, 3)."""
    angle = generator.uniform(0, 2 * np.pi, (len(rows), 200))
    height = generator.choice([-1.0, 1.0], (len(rows), 200))
    rims = torch.from_numpy(np.stack([np.cos(angle), np.sin(angle), height], axis=-1))
    local = rims * rows[:, None, EXTENTS] / 2
    return local @ rotation(rows[:, QUATERNION]).transpose(1, 2) + rows[:, None, POSITION]


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS)
def test_a_gap_is_never_wider_than_the_room_between_the_two(seed):
    generator = np.random.default_rng(seed)
    places, objects = random_rows(generator, 40).split(20)
    room = torch.cdist(surface(places, generator), surface(objects, generator)).amin(dim=(1, 2))
    gaps = UNIT * pair_features(places, objects)[:, GAP]
    assert (gaps <= room + 1e-6).all()


@given(seed=SEEDS)
def test_a_pair_that_is_turned_and_moved_together_is_the_same_pair(seed):
    generator = np.random.default_rng(seed)
    rows = random_rows(generator, 40)
    turn = Rotation.random(rng=generator)
    moved = rows.clone()
    moved[:, POSITION] = torch.from_numpy(turn.apply(rows[:, POSITION]) + generator.random(3))
    turned = turn * Rotation.from_quat(rows[:, QUATERNION], scalar_first=True)
    moved[:, QUATERNION] = torch.from_numpy(turned.as_quat(scalar_first=True))
    before, after = (pair_features(*pair.split(20)) for pair in (rows, moved))
    assert torch.allclose(before, after, atol=1e-6)

"""The collision model: what it may depend on, the geometry of shapes, and that shapes learn."""

import numpy as np
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from kitchen_prefs.instances import COLUMNS, EXTENTS, IS_OBJECT, IS_PLACE, POSITION, QUATERNION
from lerobot_policy_kitchen_prefs.common.collision_model import (
    CollisionModel,
    rotation_matrices,
    signed_distances,
)

SEEDS = st.integers(0, 10_000)
CLOSE = {"atol": 1e-4, "rtol": 1e-4}


def log_free(sets):
    """The log-probabilities of an untrained model, the same one each time."""
    torch.manual_seed(0)
    return CollisionModel()(sets)


def test_only_places_are_predicted(place_sets):
    free = log_free(place_sets)
    is_place = place_sets[..., IS_PLACE] > 0
    assert (free[is_place] <= 0).all()
    assert (free[is_place] < -1).any()
    assert not free[~is_place].any()


def test_what_the_expert_chose_begins_less_blocked_than_other_places(pairs):
    is_place = (pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    sets, targets = pairs.sets[is_place], pairs.targets[is_place]
    blocked = 1 - log_free(sets).exp()
    chosen = blocked[torch.arange(len(sets)), targets]
    assert chosen.mean() < blocked[sets[..., IS_PLACE] > 0].mean() / 2


def test_in_pick_decisions_nothing_is_blocked(pairs):
    is_pick = ~(pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    assert not log_free(pairs.sets[is_pick]).any()


@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_the_prediction_follows_the_rows(place_sets, seed):
    order = torch.from_numpy(np.random.default_rng(seed).permutation(place_sets.shape[1]))
    assert torch.allclose(log_free(place_sets[:, order]), log_free(place_sets)[:, order], **CLOSE)


@settings(max_examples=10, deadline=None)
@given(shift=st.tuples(*[st.floats(-1, 1, width=32)] * 3))
def test_the_prediction_does_not_depend_on_where_the_rack_is(place_sets, shift):
    shifted = place_sets.clone()
    is_real = (place_sets != 0).any(dim=-1, keepdim=True)
    shifted[..., POSITION] += torch.tensor(shift) * is_real
    assert torch.allclose(log_free(shifted), log_free(place_sets), **CLOSE)


def with_an_object(sets, position):
    """The sets with one more object, of the size of the first place, (B, N + 1, 13)."""
    first_place = (sets[..., IS_PLACE] > 0).int().argmax(dim=1)
    added = sets[torch.arange(len(sets)), first_place].clone()  # (B, 13)
    added[:, POSITION] += torch.tensor(position)
    added[:, IS_PLACE], added[:, IS_OBJECT] = 0, 1
    return torch.cat([sets, added[:, None]], dim=1)


def test_a_near_object_blocks_and_a_far_one_does_not(place_sets):
    before = log_free(place_sets)
    far = log_free(with_an_object(place_sets, (0.0, 0.0, 2.0)))[:, :-1]
    near = log_free(with_an_object(place_sets, (0.0, 0.0, 0.0)))[:, :-1]
    assert torch.allclose(far, before, **CLOSE)
    assert (near <= before + 1e-4).all()
    assert (near < before - 1e-2).any(dim=1).all()


def random_rows(generator, number):
    """Instances of the sizes of dishes, turned at random, within half a metre, (number, 13)."""
    rows = np.zeros((number, COLUMNS))
    rows[:, EXTENTS] = generator.uniform(0.02, 0.3, (number, 3))
    rows[:, POSITION] = generator.uniform(-0.25, 0.25, (number, 3))
    rows[:, QUATERNION] = Rotation.random(number, rng=generator).as_quat(scalar_first=True)
    return torch.from_numpy(rows)


@settings(deadline=None)
@given(seed=SEEDS)
def test_rotation_matrices_are_scipy_s(seed):
    quaternions = Rotation.random(20, rng=seed).as_quat(scalar_first=True)
    expected = Rotation.from_quat(quaternions, scalar_first=True).as_matrix()
    assert np.allclose(rotation_matrices(torch.from_numpy(quaternions)).numpy(), expected)


@settings(deadline=None)
@given(seed=SEEDS)
def test_a_signed_distance_is_that_of_the_two_nearest_spheres(seed):
    generator = np.random.default_rng(seed)
    a, b = torch.from_numpy(generator.uniform(-0.2, 0.2, (2, 20, 5, 3)))
    a_radii, b_radii = torch.from_numpy(generator.uniform(0, 0.02, (2, 20, 5)))
    apart = (a[:, :, None] - b[:, None]).norm(dim=-1) - a_radii[:, :, None] - b_radii[:, None]
    distances = signed_distances(a, a_radii, b, b_radii)
    assert torch.allclose(distances, apart.amin(dim=(1, 2)), atol=1e-6)
    assert torch.allclose(distances, signed_distances(b, b_radii, a, a_radii), atol=1e-6)


def random_pairs(generator):
    """Sets of a place and an object of a dish's size, within half a metre, (20, 2, 13)."""
    rows = random_rows(generator, 40).unflatten(0, (20, 2)).float()
    rows[:, 0, IS_PLACE], rows[:, 1, IS_OBJECT] = 1, 1
    return rows


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS)
def test_a_pair_that_is_turned_and_moved_together_is_the_same_pair(seed):
    generator = np.random.default_rng(seed)
    sets = random_pairs(generator)
    turn = Rotation.random(rng=generator)
    moved = sets.clone()
    position, quaternion = sets[..., POSITION].reshape(-1, 3), sets[..., QUATERNION].reshape(-1, 4)
    position = turn.apply(position) + generator.random(3)
    turned = turn * Rotation.from_quat(quaternion, scalar_first=True)
    moved[..., POSITION] = torch.from_numpy(position).reshape(20, 2, 3)
    moved[..., QUATERNION] = torch.from_numpy(turned.as_quat(scalar_first=True)).reshape(20, 2, 4)
    assert torch.allclose(log_free(moved), log_free(sets), atol=1e-2)  # 20 micrometres


def test_shapes_learn_which_of_two_similar_pairs_collide():
    sets = random_pairs(np.random.default_rng(0))[:1].repeat(2, 1, 1)
    sets[:, :, EXTENTS] = torch.tensor([0.1, 0.1, 0.14])
    sets[:, 1, POSITION] = sets[:, 0, POSITION] + torch.tensor([[0.07, 0, 0], [0.09, 0, 0]])
    sets[:, :, QUATERNION] = torch.tensor([1.0, 0, 0, 0])  # side by side, 7 and 9 cm apart
    model = CollisionModel()
    assert (model(sets)[:, 0] < -1).all()  # cylinders 10 cm wide collide
    optimizer = torch.optim.Adam(model.parameters(), lr=3e-3)
    for _ in range(100):
        near, far = model(sets)[:, 0]
        loss = -far - torch.log1p(-near.exp())
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    near, far = model(sets)[:, 0].exp()
    assert near < 0.1
    assert far > 0.9

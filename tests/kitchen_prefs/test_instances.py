"""Instance sets: what is packed comes back, in both tiers."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kitchen_prefs import instances

WIDTHS = sorted(instances.CAPACITIES)  # of the rows of both tiers
either_width = st.sampled_from(WIDTHS)


@st.composite
def sets(draw, widths=either_width):
    width = draw(widths)
    n = draw(st.integers(1, instances.CAPACITIES[width]))
    values = st.floats(-10, 10, width=32)
    rows = draw(arrays(np.float32, (n, width), elements=values))
    places = draw(arrays(bool, n))
    rows[:, instances.IS_OBJECT] = ~places
    rows[:, instances.IS_PLACE] = places
    return rows


several_sets = either_width.flatmap(
    lambda width: st.lists(sets(st.just(width)), min_size=1, max_size=4)
)


@given(sets())
def test_unpad_gives_back_what_pack_took(rows):
    padded = instances.pack(rows)
    assert padded.shape == (instances.CAPACITIES[rows.shape[1]], rows.shape[1])
    np.testing.assert_array_equal(instances.unpad(padded), rows)
    np.testing.assert_array_equal(instances.unpad(padded.ravel()), rows)


@given(sets())
def test_a_decision_chooses_places_if_there_are_any(rows):
    mask = instances.choosable(instances.pack(rows))
    assert mask.any()
    wanted = instances.IS_PLACE if instances.is_place_decision(rows) else instances.IS_OBJECT
    np.testing.assert_array_equal(mask[: len(rows)], rows[:, wanted] > 0)
    assert not mask[len(rows) :].any()


@pytest.mark.parametrize("kind", [np.asarray, torch.from_numpy], ids=["numpy", "torch"])
@given(several_sets)
def test_a_batch_is_treated_like_each_of_its_sets_as_rows_or_flat(kind, several):
    alone = [instances.pack(rows) for rows in several]
    batch = kind(np.stack(alone)[:, None])  # (B, 1, N, D)
    flat = batch.reshape(len(alone), 1, -1)  # (B, 1, N D)
    for function in (instances.is_real, instances.is_place_decision, instances.choosable):
        expected = np.stack([function(rows) for rows in alone])[:, None]
        np.testing.assert_array_equal(function(batch), expected)
        np.testing.assert_array_equal(function(flat), expected)


@pytest.mark.parametrize("width", WIDTHS)
def test_too_large_a_set_is_refused(width):
    rows = np.ones((instances.CAPACITIES[width] + 1, width), dtype=np.float32)
    with pytest.raises(ValueError, match="does not fit the capacity"):
        instances.pack(rows)

"""Instance sets: what is packed comes back."""

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from kitchen_prefs import instances


@st.composite
def sets(draw):
    n = draw(st.integers(1, instances.CAPACITY))
    values = st.floats(-10, 10, width=32)
    rows = draw(arrays(np.float32, (n, instances.COLUMNS), elements=values))
    places = draw(arrays(bool, n))
    rows[:, instances.IS_OBJECT] = ~places
    rows[:, instances.IS_PLACE] = places
    return rows


@given(sets())
def test_unpad_gives_back_what_pack_took(rows):
    padded = instances.pack(rows)
    assert padded.shape == (instances.CAPACITY, instances.COLUMNS)
    np.testing.assert_array_equal(instances.unpad(padded), rows)


@given(sets())
def test_a_decision_chooses_places_if_there_are_any(rows):
    mask = instances.choosable(instances.pack(rows))
    assert mask.any()
    wanted = instances.IS_PLACE if instances.is_place_decision(rows) else instances.IS_OBJECT
    np.testing.assert_array_equal(mask[: len(rows)], rows[:, wanted] > 0)
    assert not mask[len(rows) :].any()


@pytest.mark.parametrize("kind", [np.asarray, torch.from_numpy], ids=["numpy", "torch"])
@given(st.lists(sets(), min_size=1, max_size=4))
def test_a_batch_is_treated_like_each_of_its_sets(kind, several):
    alone = [instances.pack(rows) for rows in several]
    batch = kind(np.stack(alone)[:, None])  # (B, 1, N, 13)
    for function in (instances.is_real, instances.is_place_decision, instances.choosable):
        expected = np.stack([function(rows) for rows in alone])[:, None]
        np.testing.assert_array_equal(function(batch), expected)


def test_too_large_a_set_is_refused():
    rows = np.ones((instances.CAPACITY + 1, instances.COLUMNS), dtype=np.float32)
    with pytest.raises(ValueError, match="does not fit the capacity"):
        instances.pack(rows)

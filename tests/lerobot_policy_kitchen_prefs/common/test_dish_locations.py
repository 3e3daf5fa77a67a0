"""Dish locations: what rows say is where the kitchen's dishes are, under noise too."""

import numpy as np
import pytest
import torch

from kitchen_prefs.envs.observations import Observer
from kitchen_prefs.simulation.kitchen import FIRST_DISH, FIRST_PLACEMENT, SINK, Kitchen, Location
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from lerobot_policy_kitchen_prefs.common.dish_locations import in_rack, in_top_rack, on_counter


def observed_rows(session, noise):
    """The rows of all dishes, places in racks and the sink of an episode, and their locations."""
    kitchen = Kitchen(session.dishes)
    observer = Observer(kitchen, np.random.default_rng(0), noise)
    locations = {SINK: Location.SINK}
    rows, expected = [], []
    for decision in expert_trajectory(session).decisions:
        seen = observer.observe()
        locations |= {FIRST_DISH + dish: at for dish, at in enumerate(kitchen.location)}
        if kitchen.open_rack is not None:
            at = Location.TOP if kitchen.open_rack == "top" else Location.BOTTOM
            first = FIRST_PLACEMENT[kitchen.open_rack]
            locations |= {i: at for i in seen.ids.tolist() if i >= first}
        known = np.array([i in locations for i in seen.ids.tolist()])
        rows.append(seen.rows[known])
        expected.append([locations[i] for i in seen.ids[known].tolist()])
        kitchen.decide(decision)
    return np.concatenate(rows), np.concatenate(expected)


@pytest.mark.parametrize("split", ["val", "noisy"])
@pytest.mark.parametrize("kind", [np.asarray, torch.from_numpy], ids=["numpy", "torch"])
def test_rows_are_where_the_kitchen_has_them(split, kind):
    noise = np.random.default_rng(1) if split == "noisy" else None
    for index in range(0, 60, 12):
        rows, location = observed_rows(make_session(split, index), noise)
        rows = kind(rows)
        racked = np.isin(location, [Location.TOP, Location.BOTTOM])
        assert set(location) > {Location.COUNTER, Location.TOP, Location.BOTTOM}
        np.testing.assert_array_equal(in_rack(rows), racked)
        np.testing.assert_array_equal(on_counter(rows), location == Location.COUNTER)
        np.testing.assert_array_equal(in_top_rack(rows)[racked], location[racked] == Location.TOP)

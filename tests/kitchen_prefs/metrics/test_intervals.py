"""Means over episodes and their bootstrap intervals."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_up_episodes import episode_of, episodes

from kitchen_prefs.metrics import (
    METRICS,
    Interval,
    mean_of_groups,
    packing_efficiency,
    prompt_use,
    summarise,
    summarise_all,
    wilson,
    wilson_success,
)
from kitchen_prefs.metrics.scores import turn_accuracy


def spread(split, packed_by_preference):
    """Episodes whose top rack got 2 of 2 (PE 1) or 0 of 2 (PE 1/2), by preference."""
    flags = [(label, packed) for label, all_ in packed_by_preference.items() for packed in all_]
    return [
        episode_of(split=split, session=i, preference=label, placed=(2 * packed, 1))
        for i, (label, packed) in enumerate(flags)
    ]


def test_an_interval_is_as_wide_as_theory_says():
    interval = summarise(spread("seen", {0: [True, False] * 50}), packing_efficiency)
    assert interval.mean == 0.75
    # Standard error of a mean of 100 fair choices between 1/2 and 1: .025.
    assert interval.high - interval.low == pytest.approx(2 * 1.96 * 0.025, rel=0.1)


def test_sessions_are_resampled_within_preferences():
    differing = {0: [True] * 10, 1: [False] * 10}
    fixed = summarise(spread("seen", differing), packing_efficiency)
    assert fixed.low == fixed.high == fixed.mean == 0.75


def test_on_many_preferences_the_preferences_are_resampled():
    differing = {label: [label % 2 == 0] * 2 for label in range(40)}
    sampled = summarise(spread("many_preferences", differing), packing_efficiency)
    # Forty independent preferences, however many sessions each: standard error .25 / sqrt(40).
    assert sampled.high - sampled.low == pytest.approx(2 * 1.96 * 0.25 / 40**0.5, rel=0.15)


def test_of_one_preference_the_sessions_are_resampled():
    interval = summarise(spread("many_preferences", {7: [True, False] * 20}), packing_efficiency)
    assert interval.low < interval.mean < interval.high


def test_single_sessions_do_not_make_an_interval_vanish():
    interval = summarise(spread("seen", {0: [True], 1: [False], 2: [True]}), packing_efficiency)
    assert interval.low < interval.mean < interval.high


@given(st.lists(episodes, min_size=1, max_size=12))
def test_an_interval_encloses_its_mean_and_is_repeatable(some):
    interval = summarise(some, packing_efficiency)
    assert interval.low - 1e-9 <= interval.mean <= interval.high + 1e-9
    assert summarise(some, packing_efficiency) == interval


def test_nothing_cannot_be_summarised():
    with pytest.raises(ValueError, match="no episodes"):
        summarise([], packing_efficiency)


def test_prompt_use_pairs_sessions():
    right = spread("seen", {0: [True] * 8, 1: [True, False] * 4})
    ignoring = prompt_use(right, right[::-1])
    assert (ignoring.mean, ignoring.low, ignoring.high) == (0, 0, 0)
    other = [replace(episode, placed=(0, 1)) for episode in right]
    assert prompt_use(right, other).mean == pytest.approx(12 / 16 / 2)
    with pytest.raises(ValueError, match="the same sessions"):
        prompt_use(right, other[:-1])


def test_an_episode_without_a_value_is_left_out_of_the_mean():
    some = [episode_of(turns=(1, 2)), episode_of(turns=(0, 0)), episode_of(turns=(2, 2))]
    assert summarise(some, turn_accuracy).mean == 0.75
    metrics = summarise_all(some[1:2])
    assert "Turn" not in metrics
    assert metrics.keys() >= METRICS.keys()


def test_files_hold_four_digits():
    assert Interval(1 / 3, -1 / 3, 2 / 3).rounded() == Interval(0.3333, -0.3333, 0.6667)


@pytest.mark.parametrize(
    ("successes", "low", "high"),
    # By hand: (p + z^2/2n +- z sqrt(p(1 - p)/n + z^2/4n^2)) / (1 + z^2/n), z = 1.96, n = 10.
    [(10, 0.722, 1.0), (0, 0.0, 0.278), (5, 0.237, 0.763)],
)
def test_success_has_a_width_even_where_all_succeed(successes, low, high):
    perfect = [episode_of(session=i, placed=(2, 1)) for i in range(successes)]
    failed = [episode_of(session=10 + i, placed=(0, 1)) for i in range(10 - successes)]
    interval = wilson_success(perfect + failed)
    assert interval.mean == successes / 10
    assert (interval.low, interval.high) == pytest.approx((low, high), abs=0.001)


def test_values_of_one_group_do_not_narrow_its_interval():
    alone = mean_of_groups([[0.0], [1.0], [0.5], [1.0]])
    assert mean_of_groups([[0.0] * 9, [1.0] * 9, [0.5] * 9, [1.0] * 9]) == alone
    assert alone.low < alone.mean == 0.625 < alone.high


def test_groups_of_one_mean_have_the_interval_of_wilson():
    assert mean_of_groups([[1.0, 1.0]] * 10) == wilson(10, 10)
    between = mean_of_groups([[0.5, 1.0]] * 10)  # 7.5 of 10
    assert (between.low, between.mean, between.high) == (
        wilson(7, 10).low,
        0.75,
        wilson(8, 10).high,
    )
    with pytest.raises(ValueError, match="no episodes"):
        mean_of_groups([])

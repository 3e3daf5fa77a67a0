"""The metrics by hand-worked examples, their bounds, and their intervals."""

from dataclasses import replace

import pytest
import textdistance
from hypothesis import given
from hypothesis import strategies as st
from textdistance.algorithms.base import libraries

from kitchen_prefs.metrics import (
    METRICS,
    Episode,
    category_accuracy,
    category_edit_similarity,
    edit_similarity,
    failure_modes,
    packing_efficiency,
    prompt_use,
    score,
    success,
    summarise,
    temporal_efficiency,
)

KIND = {0: "door", 1: "bottom rack", 2: "top rack", 3: "cup", 4: "cup", 5: "tray", 999: "in sink"}
KIND |= {1000 + k: "in bottom" for k in range(3)} | {2000 + k: "in top" for k in range(3)}

# Two cups into the top rack, a tray into the bottom one.
CUPS = (2, 3, 2000, 4, 2001, 2)
TRAY = (1, 5, 1000, 1)
EXPERT = (0, *CUPS, *TRAY, 0)


def episode_of(decisions=EXPERT, **facts) -> Episode:
    """An episode in which the expert decides EXPERT and the policy the given decisions."""
    perfect = {
        "split": "seen",
        "session": 0,
        "salt": 0,
        "preference": 0,
        "count": 2,
        "decisions": decisions,
        "kinds": tuple(KIND[d] for d in decisions),
        "expert_decisions": EXPERT,
        "expert_kinds": tuple(KIND[d] for d in EXPERT),
        "placed": (2, 1),
        "expert_placed": (2, 1),
        "wrong_rack": 0,
        "sunk": 0,
        "expert_sunk": 0,
        "refused": (False,) * len(decisions),
        "blocked_places": 0,
        "longest_loop": 0,
        "turns": (2, 2),
        "closed_early": 0,
        "closed": True,
        "finished": True,
        "actions": ((0.0,) * 7,) * len(decisions),
    }
    return Episode(**(perfect | facts))


episodes = st.builds(
    lambda decisions, **facts: episode_of(tuple(decisions), **facts),
    st.lists(st.sampled_from(sorted(KIND)), max_size=2 * len(EXPERT)),
    placed=st.tuples(st.integers(0, 5), st.integers(0, 5)),
    expert_placed=st.tuples(st.integers(0, 5), st.integers(0, 5)),
    preference=st.integers(0, 3),
    closed=st.booleans(),
    finished=st.booleans(),
)


def test_the_expert_is_perfect():
    expert = episode_of()
    assert {name: metric(expert) for name, metric in METRICS.items()} == dict.fromkeys(METRICS, 1)
    assert not any(failure_modes(expert).values())


def test_swapped_racks_keep_packing_and_cost_order():
    swapped = episode_of((0, *TRAY, *CUPS, 0))
    assert packing_efficiency(swapped) == 1
    # Four decisions are taken out before the cups and put in after them: 8 edits of 12.
    assert edit_similarity(swapped) == pytest.approx(1 - 8 / 12)
    assert score(swapped) == pytest.approx((1 + category_edit_similarity(swapped)) / 2)
    assert success(swapped)


def test_swapping_two_like_cups_is_forgiven_over_categories():
    cups = episode_of((0, 2, 4, 2000, 3, 2001, 2, *TRAY, 0))
    assert edit_similarity(cups) == pytest.approx(1 - 2 / 12)
    assert category_edit_similarity(cups) == 1


def test_a_dish_in_the_wrong_rack_lowers_packing():
    wrong = episode_of(placed=(1, 1), wrong_rack=1)
    assert packing_efficiency(wrong) == pytest.approx((1 / 2 + 1) / 2)
    assert not success(wrong)
    assert failure_modes(wrong)["wrong rack"] == 1


def test_a_kitchen_left_open_or_with_dishes_waiting_is_no_success():
    assert success(episode_of())
    assert not success(episode_of(closed=False))
    # The expert drops what does not fit in the sink; leaving it on the counter packs as well.
    assert not success(episode_of(finished=False, expert_sunk=1))


def test_all_dishes_in_wrong_racks_pack_nothing():
    assert packing_efficiency(episode_of(placed=(0, 0), wrong_rack=3)) == 0


def test_a_rack_that_both_leave_empty_counts_one():
    assert packing_efficiency(episode_of(placed=(2, 0), expert_placed=(2, 0))) == 1
    assert packing_efficiency(episode_of(placed=(0, 0), expert_placed=(0, 0))) == 1
    assert packing_efficiency(episode_of(placed=(2, 1), expert_placed=(2, 0))) == 1


def test_looping_lowers_temporal_efficiency_and_drives_order_below_zero():
    looping = episode_of((0,) * 36, placed=(2, 1), longest_loop=36)
    assert temporal_efficiency(looping) == pytest.approx(12 / 36)
    assert edit_similarity(looping) == pytest.approx(1 - 34 / 12)
    assert score(looping) == pytest.approx(1 / 2)
    assert failure_modes(looping)["looped on a forbidden decision"] == 1


def test_a_short_episode_gains_no_time():
    assert temporal_efficiency(episode_of((0,), placed=(1, 1))) == pytest.approx(3 / 4)


def test_category_accuracy_counts_the_experts_categories():
    choices = episode_of((0, 2, 4, 2001, 4, 2001, 1, *TRAY, 0))
    assert category_accuracy(choices) == pytest.approx(11 / 12)


def test_sinking_what_the_expert_sinks_is_no_shortcoming():
    reasons = failure_modes(episode_of(sunk=3, expert_sunk=2, closed_early=2, blocked_places=1))
    assert reasons["sunk without need"] == 1
    assert reasons["closed early"] == 2
    assert reasons["blocked place"] == 1
    assert failure_modes(episode_of(sunk=1, expert_sunk=2))["sunk without need"] == 0


def test_facts_that_do_not_agree_are_refused():
    with pytest.raises(ValueError, match=r"session 0 of seen.*differ in length"):
        replace(episode_of(), refused=())
    with pytest.raises(ValueError, match="nothing to compare"):
        replace(episode_of(), expert_decisions=(), expert_kinds=())


@given(episodes)
def test_bounds(episode):
    p, e = len(episode.decisions), len(episode.expert_decisions)
    assert 0 <= packing_efficiency(episode) <= 1
    assert 0 <= temporal_efficiency(episode) <= packing_efficiency(episode)
    assert 0 <= score(episode) <= 1
    assert 1 - max(p, e) / e <= edit_similarity(episode) <= category_edit_similarity(episode) <= 1
    assert (edit_similarity(episode) == 1) == (episode.decisions == episode.expert_decisions)
    assert success(episode) <= packing_efficiency(episode)


@given(episodes)
def test_packing_does_not_see_order(episode):
    backwards = replace(episode, decisions=episode.decisions[::-1], kinds=episode.kinds[::-1])
    assert packing_efficiency(backwards) == packing_efficiency(episode)


@given(episodes)
def test_rapidfuzz_gives_what_textdistance_itself_gives(episode):
    slow = textdistance.Levenshtein(external=False)
    for policy, expert in (
        (episode.decisions, episode.expert_decisions),
        (episode.kinds, episode.expert_kinds),
    ):
        assert textdistance.levenshtein(policy, expert) == slow(policy, expert)


def test_rapidfuzz_is_the_engine(monkeypatch):
    # textdistance swallows a missing engine silently, so put a marked one in its place.
    engine = next(
        library
        for library in libraries.get_libs("Levenshtein")
        if library.module_name.startswith("rapidfuzz") and library.get_function() is not None
    )
    monkeypatch.setattr(engine, "func", lambda policy, expert: 6)
    assert edit_similarity(episode_of((0, 1))) == 1 - 6 / 12
    assert category_edit_similarity(episode_of((0, 1))) == 1 - 6 / 12


# Intervals ------------------------------------------------------------------------------------


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

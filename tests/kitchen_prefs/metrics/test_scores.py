"""The metrics by hand-worked examples, and their bounds."""

from dataclasses import replace

import pytest
import textdistance
from hypothesis import given
from hypothesis import strategies as st
from made_up_episodes import CUPS, TRAY, episode_of, episodes
from textdistance.algorithms.base import libraries

from kitchen_prefs.metrics import (
    METRICS,
    category_accuracy,
    category_edit_similarity,
    count_failure_modes,
    edit_similarity,
    failure_modes,
    packing_efficiency,
    reference_scores,
    score,
    success,
    temporal_efficiency,
)
from kitchen_prefs.metrics.scores import (
    category_edit_similarity_without_refused,
    refused_decisions,
    rescaled_score,
    turn_accuracy,
)
from kitchen_prefs.splits import TEST_SPLITS


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


def test_sinking_what_the_expert_sinks_is_no_failure():
    reasons = failure_modes(episode_of(sunk=3, expert_sunk=2, closed_early=2, blocked_places=1))
    assert reasons["sunk without need"] == 1
    assert reasons["closed early"] == 2
    assert reasons["blocked place"] == 1
    assert failure_modes(episode_of(sunk=1, expert_sunk=2))["sunk without need"] == 0


def test_failure_modes_are_counted_by_episodes_and_in_all():
    counts = count_failure_modes(failure_modes(episode_of(wrong_rack=wrong)) for wrong in (0, 2, 1))
    assert counts["wrong rack"] == (2, 3)
    assert counts["closed early"] == (0, 0)


@given(episodes)
def test_bounds(episode):
    p, e = len(episode.decisions), len(episode.expert_decisions)
    assert 0 <= packing_efficiency(episode) <= 1
    assert 0 <= temporal_efficiency(episode) <= packing_efficiency(episode)
    assert 0 <= score(episode) <= 1
    assert 1 - max(p, e) / e <= edit_similarity(episode) <= category_edit_similarity(episode) <= 1
    assert (edit_similarity(episode) == 1) == (episode.decisions == episode.expert_decisions)
    assert success(episode) <= packing_efficiency(episode)
    assert 0 <= turn_accuracy(episode) <= 1
    assert 0 <= refused_decisions(episode) <= p
    assert 1 - max(p, e) / e <= category_edit_similarity_without_refused(episode) <= 1
    # A decision more or less moves the distance by one at most.
    gain = category_edit_similarity_without_refused(episode) - category_edit_similarity(episode)
    assert abs(gain) <= refused_decisions(episode) / e + 1e-9


@given(episodes, st.sampled_from(TEST_SPLITS))
def test_the_rescaled_score_is_0_at_the_floor_and_1_at_the_ceiling(episode, split):
    reference = reference_scores()[split]
    assert 0 < reference["floor"] < reference["ceiling"] < 1
    episode = replace(episode, split=split)
    between = reference["floor"] + rescaled_score(episode) * (
        reference["ceiling"] - reference["floor"]
    )
    assert between == pytest.approx(score(episode))


def test_a_split_without_floor_and_ceiling_has_no_rescaled_score():
    assert rescaled_score(episode_of(split="val")) is None


def test_turns_are_shared_out():
    assert turn_accuracy(episode_of(turns=(3, 4))) == 3 / 4
    assert turn_accuracy(episode_of(turns=(0, 0))) is None


def test_refused_decisions_are_counted_and_left_out_of_the_order():
    tried_twice = (0, 2, 3, 2001, 2000, 4, 2001, 2, *TRAY, 0)
    refused = tuple(i == 3 for i in range(len(tried_twice)))
    episode = episode_of(tried_twice, refused=refused)
    assert refused_decisions(episode) == 1
    assert category_edit_similarity(episode) == pytest.approx(1 - 1 / 12)
    assert category_edit_similarity_without_refused(episode) == 1


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

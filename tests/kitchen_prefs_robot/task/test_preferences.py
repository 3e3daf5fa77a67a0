"""Preferences about drawers, and how the splits part them."""

import pytest

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs_robot.task.preferences import (
    LABELS,
    PREFERENCES,
    DrawerPreference,
    partitions,
)


def partition_of(preference):
    return frozenset({frozenset(preference.upper), frozenset(preference.lower)})


def test_each_partition_of_two_to_four_categories_has_one_preference():
    known = {frozenset(map(frozenset, partition)) for partition in partitions()}
    assert len(known) == len(partitions()) == 21 + 35 * 3 + 35 * 7
    assert sorted(map(len, known)) == [2] * len(known)
    assert {partition_of(preference) for preference in PREFERENCES} == known
    assert len(PREFERENCES) == len(known)


def test_the_splits_have_no_partition_in_common_and_leave_none_out():
    labels = [label for split in LABELS.values() for label in split]
    assert sorted(labels) == list(range(len(PREFERENCES)))


def test_no_partition_of_the_paper_s_dishes_is_seen_in_training():
    labels = [
        label
        for label, preference in enumerate(PREFERENCES)
        if set(preference.categories) == {"small bowl", "big bowl", "cup", "small plate"}
    ]
    assert len(labels) == 7
    assert set(labels) <= set(LABELS["test"])


@pytest.mark.parametrize("split", LABELS)
def test_each_split_has_all_categories_in_both_drawers_and_both_orders_of_drawers(split):
    chosen = [PREFERENCES[label] for label in LABELS[split]]
    for drawer in ("upper", "lower"):
        assert {c for preference in chosen for c in preference.order(drawer)} == set(CATEGORIES)
    assert {preference.first for preference in chosen} == {"upper", "lower"}


def test_the_opposite_preference_keeps_the_order_of_the_drawers_and_moves_each_category():
    preference = DrawerPreference("lower", ("cup", "tray"), ("glass",))
    opposite = preference.opposite()
    assert opposite.drawers == preference.drawers == ("lower", "upper")
    assert all(opposite.drawer_of[c] != preference.drawer_of[c] for c in preference.categories)
    assert preference.in_words == (
        "Load the lower drawer with glasses; then the upper drawer with cups, then trays."
    )


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("middle", ("cup",), ("glass",)), "There is no drawer 'middle'"),
        (("upper", ("cop",), ("glass",)), "There is no category 'cop'. Did you mean 'cup'"),
        (("upper", (), ("glass",)), "gives each drawer one category or more"),
        (("upper", ("cup",), ("cup",)), "names a category once"),
    ],
)
def test_a_wrong_preference_is_refused_in_a_sentence(arguments, sentence):
    with pytest.raises(ValueError, match=sentence):
        DrawerPreference(*arguments)

"""The order of the rows: by Score, with ties, each track by itself, re-run rows first."""

import json

import pytest

from kitchen_prefs_leaderboard.judgement import Reruns, compare
from kitchen_prefs_leaderboard.ranking import Row, lead, rank
from kitchen_prefs_leaderboard.scoring import MEAN, score_submissions
from kitchen_prefs_leaderboard.submission_writing import write_submission


def confirmed(entry, rerun, fresh):
    """The record of a re-run."""
    reruns = Reruns(rerun, fresh, alone=rerun)
    return compare(entry, reruns, salt=1, by="A. Maintainer", sandbox=True)


ALL = range(6)  # all sessions of a split that was cut short


@pytest.fixture
def shown():
    """The name, rank and tie of each row of each track."""

    def show(entries, again=None):
        verified = {
            entry.digest: confirmed(entry, entry.episodes, entry.episodes)
            for entry in (entries if again is None else again)
        }
        return {
            track: [(row.entry.submission.name, row.rank, row.tied) for row in rows]
            for track, rows in rank(entries, verified).items()
        }

    return show


def test_rows_stand_by_score(make_entry, shown):
    worst, best = make_entry("a", worse=ALL), make_entry("b")
    assert shown([worst, best]) == {"privileged": [("b", 1, False), ("a", 2, False)]}


def test_equal_entries_share_a_rank_and_the_next_one_counts_them(make_entry, shown):
    entries = [make_entry("a"), make_entry("b"), make_entry("c", worse=ALL)]
    assert shown(entries) == {"privileged": [("a", 1, True), ("b", 1, True), ("c", 3, False)]}


def test_a_difference_inside_the_paired_interval_is_a_tie(make_entry, shown):
    best, near = make_entry("a"), make_entry("b", worse=[0])
    gain = lead(Row(best), Row(near))
    assert gain.low == 0 < gain.mean == -lead(Row(near), Row(best)).mean
    assert shown([near, best]) == {"privileged": [("a", 1, True), ("b", 1, True)]}


def test_entries_whose_own_intervals_overlap_may_still_differ(make_entry, shown):
    better, worse = make_entry("a", worse=range(2)), make_entry("b", worse=range(5))
    assert better.metrics[MEAN]["Score"].low < worse.metrics[MEAN]["Score"].high
    assert shown([worse, better]) == {"privileged": [("a", 1, False), ("b", 2, False)]}


def test_a_row_ties_with_the_first_of_a_rank_not_with_the_last(make_entry, shown):
    first, second, third = (make_entry("abc"[n], worse=range(2 * n)) for n in range(3))
    assert lead(Row(second), Row(third)).low == 0
    assert shown([first, second, third]) == {
        "privileged": [("a", 1, True), ("b", 1, True), ("c", 3, False)]
    }


def test_what_a_rerun_does_not_reach_does_not_count(make_entry):
    inflated, honest = make_entry("a"), make_entry("b", worse=[0])
    records = {
        "a" * 64: confirmed(inflated, make_entry("c", worse=range(3)).episodes, honest.episodes),
        "b" * 64: confirmed(honest, honest.episodes, honest.episodes),
    }
    rows = rank([inflated, honest], records)["privileged"]
    assert [row.entry.submission.name for row in rows] == ["b", "a"]


def test_rows_are_ranked_by_the_rerun(make_entry):
    entries = [make_entry("a"), make_entry("b")]
    reruns = {"a": make_entry("c", worse=range(5)), "b": make_entry("d")}
    records = {
        entry.digest: confirmed(entry, reruns[entry.submission.name].episodes, entry.episodes)
        for entry in entries
    }
    first, second = rank(entries, records)["privileged"]
    assert (first.entry.submission.name, first.rank, second.rank) == ("b", 1, 2)
    assert lead(first, second).low > 0 == lead(Row(entries[0]), Row(entries[1])).high


def test_rows_that_were_only_replayed_come_last_however_good(make_entry, shown):
    good, bad = make_entry("a"), make_entry("b", worse=ALL)
    assert shown([good, bad], again=[bad]) == {"privileged": [("b", 1, False), ("a", None, False)]}


def test_tracks_are_tables_of_their_own(make_entry, shown):
    entries = [
        make_entry("a", track="open"),
        make_entry("b", track="standard", worse=ALL),
        make_entry("c", track="open", worse=ALL),
    ]
    assert shown(entries) == {
        "standard": [("b", 1, False)],
        "open": [("a", 1, False), ("c", 2, False)],
    }


@pytest.mark.usefixtures("few_sessions")
def test_rows_of_another_version_of_the_data_are_refused(make_entry, few_episodes, tmp_path):
    folders = [tmp_path / "ours", tmp_path / "theirs"]
    for folder in folders:
        write_submission(make_entry("a").submission, few_episodes(), folder)
    file = folders[1] / "submission.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {"data_version": 2}))
    with pytest.raises(ValueError, match=r"theirs is of data version 2; this version of \S+ repl"):
        score_submissions(folders, 1)

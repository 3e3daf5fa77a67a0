"""Building the page: entries as plain data, and the data in the page.

A submission is untrusted input; `kitchen_prefs.web.page` says how the page holds it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import astuple
from importlib.resources import files
from pathlib import Path
from typing import Any

from kitchen_prefs.metrics import (
    ALL_METRICS,
    Episode,
    Interval,
    packing_efficiency,
    reference_scores,
    summarise,
)
from kitchen_prefs.splits import DATA_VERSION, TEST_SPLITS, get_split
from kitchen_prefs.utils.files import atomic_file
from kitchen_prefs.web.kitchen_data import layout_data, preferences_in_words, sessions_data
from kitchen_prefs.web.page import SHARED, joined, self_contained_page
from kitchen_prefs_leaderboard.judgement import rerun_score
from kitchen_prefs_leaderboard.page.episode_data import episode_data
from kitchen_prefs_leaderboard.ranking import Row
from kitchen_prefs_leaderboard.scoring import MEAN

TEMPLATES = files("kitchen_prefs_leaderboard.page") / "templates"
# Joined in this order into one style sheet and one script.
STYLES = (SHARED / "house.css", SHARED / "drawing.css", TEMPLATES / "page.css")
SCRIPTS = (
    SHARED / "basics.js",
    TEMPLATES / "entries.js",
    TEMPLATES / "table.js",
    TEMPLATES / "charts.js",
    TEMPLATES / "failure_modes.js",
    SHARED / "kitchen.js",
    SHARED / "replay.js",
    SHARED / "drawing.js",
    TEMPLATES / "viewer.js",
    TEMPLATES / "page.js",
)
# Charts by the number of dishes: a split with the counts of training, and one with other counts.
BY_COUNT = {
    "Training preferences": ("seen", "unseen_counts"),
    "Held-out preferences": ("unseen_preferences", "unseen_both"),
}


def write_page(tables: Mapping[str, Sequence[Row]], out: Path) -> None:
    """Write the leaderboard as one HTML file, whole or not at all.

    Args:
        tables: The rows of each track.
        out: The file.
    """
    html = to_html(page_data(tables))
    with atomic_file(out) as unfinished:
        unfinished.write_text(html, encoding="utf-8")


def page_data(tables: Mapping[str, Sequence[Row]]) -> dict[str, Any]:
    """All that the page shows."""
    rows = [row for of_track in tables.values() for row in of_track]
    sessions = sessions_data(TEST_SPLITS)
    return {
        "version": DATA_VERSION,
        "mean": MEAN,
        "references": reference_scores(),
        "metrics": list(ALL_METRICS),
        "splits": {split: get_split(split).sessions for split in TEST_SPLITS},
        "failure_modes": list(rows[0].entry.failure_modes[TEST_SPLITS[0]]),
        "entries": [_entry_data(row) for row in rows],
        "layout": layout_data(),
        "preferences": preferences_in_words(sessions),
        "sessions": sessions,
    }


def to_html(data: Mapping[str, Any]) -> str:
    """The page that shows some data."""
    return self_contained_page(
        template=joined(TEMPLATES / "page.html"),
        style=joined(*STYLES),
        script=joined(*SCRIPTS),
        data=data,
    )


def _entry_data(row: Row) -> dict[str, Any]:
    entry, verification = row.entry, row.verification
    return {
        "submission": entry.submission.model_dump(exclude={"format", "fingerprints"}),
        "digest": entry.digest,
        "rank": row.rank,
        "tied": row.tied,
        "verification": verification and verification.model_dump(exclude={"digest", "scores"}),
        "metrics": _metrics(row),
        "by_count": {
            name: _by_count([episode for split in splits for episode in entry.episodes[split]])
            for name, splits in BY_COUNT.items()
        },
        "failure_modes": {split: list(of.values()) for split, of in entry.failure_modes.items()},
        "episodes": {
            split: [episode_data(episode) for episode in episodes]
            for split, episodes in entry.episodes.items()
        },
    }


def _metrics(row: Row) -> dict[str, dict[str, list[float]]]:
    """Every metric of the replay; Score is the re-run's where its record has it."""
    metrics = {
        split: {name: _numbers(interval) for name, interval in of_split.items()}
        for split, of_split in row.entry.metrics.items()
    }
    if row.verification and row.verification.scores:
        for split, of_split in metrics.items():
            of_split["Score"] = _numbers(rerun_score(row.entry, row.verification, split))
    return metrics


def _by_count(episodes: Sequence[Episode]) -> list[list[float]]:
    """PE for each number of dishes per rack: the number, mean, low, high."""
    counts = sorted({episode.count for episode in episodes})
    groups = {count: [e for e in episodes if e.count == count] for count in counts}
    return [
        [count, *_numbers(summarise(group, packing_efficiency))] for count, group in groups.items()
    ]


def _numbers(interval: Interval) -> list[float]:
    return list(astuple(interval.rounded()))

"""Building the page: entries as plain data, and the data in the page.

A submission is untrusted input; `kitchen_prefs.web.page` says how the page holds it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import astuple
from importlib.resources import files
from pathlib import Path
from typing import Any

from kitchen_prefs.evaluation.tiers import PREFERENCES, TIERS, Tier
from kitchen_prefs.metrics import Episode, Interval, packing_efficiency, summarise
from kitchen_prefs.utils.files import atomic_file
from kitchen_prefs.web.kitchen_data import layout_data, preferences_in_words, sessions_data
from kitchen_prefs.web.page import SHARED, joined, self_contained_page
from kitchen_prefs_leaderboard.judgement import rerun_headline
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

NOT_SHOWN = {"format", "fingerprints", "data_version", "data_versions"}  # of a submission


def write_page(tables: Mapping[str, Mapping[str, Sequence[Row]]], out: Path) -> None:
    """Write the leaderboard as one HTML file, whole or not at all.

    Args:
        tables: The rows of each track of each tier.
        out: The file.
    """
    html = to_html(page_data(tables))
    with atomic_file(out) as unfinished:
        unfinished.write_text(html, encoding="utf-8")


def page_data(tables: Mapping[str, Mapping[str, Sequence[Row]]]) -> dict[str, Any]:
    """All that the page shows."""
    rows = [row for of_tier in tables.values() for of_track in of_tier.values() for row in of_track]
    firsts = {row.entry.tier.name: row for row in reversed(rows)}
    sessions = sessions_data(PREFERENCES.test_splits if PREFERENCES.name in firsts else ())
    return {
        "mean": MEAN,
        "tiers": {
            name: _tier_data(tier, firsts[name]) for name, tier in TIERS.items() if name in firsts
        },
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


def _tier_data(tier: Tier, first: Row) -> dict[str, Any]:
    """What the entries of a tier have in common, of which one is given."""
    return {
        "title": tier.title,
        "version": tier.data_version,
        "headline": tier.headline,
        "ranking": tier.ranking,
        "floor": tier.floor,
        "ceiling": tier.ceiling,
        "references": {split: tier.references()[split] for split in tier.test_splits},
        "metrics": [name for names in tier.tables for name in names],
        "splits": {split: tier.sessions(split) for split in tier.test_splits},
        "failure_modes": list(first.entry.failure_modes[tier.test_splits[0]]),
    }


def _entry_data(row: Row) -> dict[str, Any]:
    entry, verification = row.entry, row.verification
    return {
        "tier": entry.tier.name,
        "submission": entry.submission.model_dump(exclude=NOT_SHOWN),
        "digest": entry.digest,
        "rank": row.rank,
        "tied": row.tied,
        "verification": verification and verification.model_dump(exclude={"digest", "scores"}),
        "metrics": _metrics(row),
        "failure_modes": {split: list(of.values()) for split, of in entry.failure_modes.items()},
        "drawn": _drawn(entry.episodes) if entry.tier is PREFERENCES else None,
    }


def _drawn(episodes: Mapping[str, Sequence[Episode]]) -> dict[str, Any]:
    """What charts and the viewer draw, whose kitchen knows the first tier's dishes alone."""
    return {
        "by_count": {
            name: _by_count([episode for split in splits for episode in episodes[split]])
            for name, splits in BY_COUNT.items()
        },
        "episodes": {split: list(map(episode_data, own)) for split, own in episodes.items()},
    }


def _metrics(row: Row) -> dict[str, dict[str, list[float]]]:
    """Every metric of the replay; the one of the ranking is the re-run's if its record has it."""
    metrics = {
        split: {name: _numbers(interval) for name, interval in of_split.items()}
        for split, of_split in row.entry.metrics.items()
    }
    if row.verification and row.verification.scores:
        for split, of_split in metrics.items():
            interval = rerun_headline(row.entry, row.verification, split)
            of_split[row.entry.tier.ranking] = _numbers(interval)
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

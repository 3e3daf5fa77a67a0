"""The committed floor and ceiling are the Scores of the rows `promptless` and `bayes`."""

import json
from pathlib import Path

from kitchen_prefs.metrics import reference_scores
from kitchen_prefs.splits import TEST_SPLITS

SCORES = Path(__file__).parents[2] / "leaderboard/scores.json"


def test_the_references_are_the_leaderboards_rows():
    rows = {row["name"]: row["splits"] for row in json.loads(SCORES.read_text())}
    assert list(reference_scores()) == list(TEST_SPLITS)
    for split, references in reference_scores().items():
        assert references["floor"] == rows["promptless"][split]["Score"]["mean"]
        assert references["ceiling"] == rows["bayes"][split]["Score"]["mean"]

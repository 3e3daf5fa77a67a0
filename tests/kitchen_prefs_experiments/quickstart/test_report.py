"""The table and the learning curve of a quickstart."""

import json

import numpy as np
from PIL import Image

from kitchen_prefs.evaluation.evaluator import Summary
from kitchen_prefs.metrics import METRICS, summarise, wilson_success
from kitchen_prefs_experiments.lerobot_train import LogEntry
from kitchen_prefs_experiments.quickstart.report import COLOURS, write_learning_curve, write_table


def test_the_table_has_a_row_for_each_policy_and_split(tmp_path, episodes):
    metrics = {name: summarise(episodes, metric) for name, metric in METRICS.items()}
    wilson = wilson_success(episodes)
    summary = Summary("unseen_preferences", len(episodes), metrics, wilson, {})
    table = write_table({"symbolic": {"unseen_preferences": summary}}, tmp_path)
    assert f"| {metrics['PE'].mean:.2f} [" in table
    assert "symbolic" in (tmp_path / "table.md").read_text()
    content = json.loads((tmp_path / "table.json").read_text())
    written = content["policies"]["symbolic"]["unseen_preferences"]["PE"]["mean"]
    assert written == metrics["PE"].mean


def test_the_learning_curve_shows_a_line_for_the_loss_and_each_accuracy(tmp_path):
    entries = [LogEntry(2 / (i + 1), i / 10, i / 20) for i in range(10)]
    write_learning_curve(entries, 50, tmp_path / "curve.png")
    pixels = np.asarray(Image.open(tmp_path / "curve.png").convert("RGB")).astype(int)
    assert pixels.shape[1] > 600
    for colour in COLOURS.values():
        red_green_blue = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        assert (np.abs(pixels - red_green_blue).sum(axis=-1) < 20).sum() > 500

"""The parts of the quickstart that need no training."""

import json
import sys

import numpy as np
import pytest
from PIL import Image

from kitchen_prefs.evaluation.evaluator import Summary
from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.evaluation.rollouts import roll_out
from kitchen_prefs.metrics import METRICS, summarise
from kitchen_prefs_experiments.quickstart import training
from kitchen_prefs_experiments.quickstart.episode_pictures import draw_episode
from kitchen_prefs_experiments.quickstart.report import COLOURS, write_learning_curve, write_table
from kitchen_prefs_experiments.quickstart.training import Logged, read_log
from kitchen_prefs_experiments.recipes import recipe_file

LOG = """\
INFO 2026-01-01 00:00:00 ot_train.py:600 step:50 smpl:2K ep:45 epch:0.08 loss:2.107 grdn:1.250 \
lr:5.0e-04 updt_s:0.103 data_s:0.002 smp/s:310 pick_accuracy:0.271 place_accuracy:0.083
INFO 2026-01-01 00:00:06 ot_train.py:600 step:100 smpl:3K ep:90 epch:0.16 loss:1.408 grdn:1.101 \
lr:1.0e-03 updt_s:0.101 data_s:0.001 smp/s:314 pick_accuracy:0.446 place_accuracy:0.152
"""


@pytest.fixture(scope="module")
def episodes():
    loaded_policy = load_policy(policy_type="rules", options=["--rule=symbolic"])
    return roll_out(loaded_policy, "unseen_preferences", sessions=range(4))


def test_the_log_of_lerobot_train_is_read(tmp_path):
    (tmp_path / "train.log").write_text(LOG)
    assert read_log(tmp_path / "train") == [
        Logged(loss=2.107, pick_accuracy=0.271, place_accuracy=0.083),
        Logged(loss=1.408, pick_accuracy=0.446, place_accuracy=0.152),
    ]


def test_a_training_that_was_stopped_begins_anew(tmp_path, monkeypatch):
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "left").touch()
    calls = []
    monkeypatch.setattr(training, "_run", lambda command, log: calls.append(command) or 0)
    training.train("ttp_quick", tmp_path / "run")
    assert not (tmp_path / "run" / "left").exists()
    assert len(calls) == 1


def test_what_lerobot_train_logs_beside_its_bar_is_kept(tmp_path):
    bar = "Training:   5%|▌         | 50/1000 [00:12<03:50,  4.12step/s]"
    script = f"print({bar!r} + {LOG.splitlines()[0]!r}); print({bar!r}, end='\\r'); print('end')"
    assert training._run([sys.executable, "-c", script], tmp_path / "train.log") == 0
    assert read_log(tmp_path / "train") == [Logged(2.107, 0.271, 0.083)]
    assert (tmp_path / "train.log").read_text().splitlines()[-1] == "end"


@pytest.mark.lerobot
def test_a_failed_training_names_its_log(tmp_path, monkeypatch):
    monkeypatch.setattr(training, "recipe_file", lambda recipe: tmp_path / "missing.yaml")
    with pytest.raises(OSError, match=r"run\.log says why"):
        training.train("ttp_quick", tmp_path / "run")
    assert "missing.yaml" in (tmp_path / "run.log").read_text()


def test_the_table_has_a_row_for_each_policy_and_split(tmp_path, episodes):
    metrics = {name: summarise(episodes, metric) for name, metric in METRICS.items()}
    summary = Summary("unseen_preferences", len(episodes), metrics, {})
    table = write_table({"symbolic": {"unseen_preferences": summary}}, tmp_path)
    assert f"| {metrics['PE'].mean:.2f} [" in table
    assert "symbolic" in (tmp_path / "table.md").read_text()
    content = json.loads((tmp_path / "table.json").read_text())
    written = content["policies"]["symbolic"]["unseen_preferences"]["PE"]["mean"]
    assert written == metrics["PE"].mean


def test_the_learning_curve_shows_a_line_for_the_loss_and_each_accuracy(tmp_path):
    logged = [Logged(2 / (i + 1), i / 10, i / 20) for i in range(10)]
    write_learning_curve(logged, 50, tmp_path / "curve.png")
    pixels = np.asarray(Image.open(tmp_path / "curve.png").convert("RGB")).astype(int)
    assert pixels.shape[1] > 600
    for colour in COLOURS.values():
        red_green_blue = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        assert (np.abs(pixels - red_green_blue).sum(axis=-1) < 20).sum() > 500


@pytest.mark.slow
def test_the_pictures_show_the_counter_cleared_and_the_racks_loaded(tmp_path, episodes):
    draw_episode(episodes[0], tmp_path)
    start, end = (
        np.asarray(Image.open(tmp_path / f"{n}.png")).astype(int) for n in ("start", "end")
    )
    changed = np.abs(start - end).max(axis=-1) > 40
    assert start.shape == end.shape == (960, 1280, 3)
    assert changed[270:380, 150:520].mean() > 0.01  # dishes stood on the counter's left end
    assert changed[450:900, 600:960].mean() > 0.2  # the racks are pulled out, with dishes in them
    assert changed[0:80].mean() < 0.001  # the wall is the same
    animation = Image.open(tmp_path / "episode.gif")
    assert animation.n_frames > len(episodes[0].actions) / 2


def test_a_recipe_that_does_not_exist_suggests_the_nearest():
    with pytest.raises(ValueError, match="Did you mean 'ttp_quick'"):
        recipe_file("ttp_quik")

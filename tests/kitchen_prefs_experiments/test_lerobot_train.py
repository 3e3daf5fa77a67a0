"""Runs of lerobot-train: started, resumed, left alone, and what their logs say."""

import shutil
from concurrent.futures import ThreadPoolExecutor

import pytest

from kitchen_prefs_experiments import lerobot_train as module
from kitchen_prefs_experiments.lerobot_train import LogEntry, TrainingRun
from kitchen_prefs_experiments.recipes import recipe_file

RECIPE = "ttp_quick"
OPTIONS = ["--steps=20"]
LINE = "INFO 2026-01-01 00:00:00 step:{} loss:2.1 updt_s:0.400 data_s:0.100 smp/s:310\n"
LOG = """\
INFO 2026-01-01 00:00:00 ot_train.py:600 step:50 smpl:2K ep:45 epch:0.08 loss:2.107 grdn:1.250 \
lr:5.0e-04 updt_s:0.103 data_s:0.002 smp/s:310 pick_accuracy:0.271 place_accuracy:0.083
INFO 2026-01-01 00:00:06 ot_train.py:600 step:100 smpl:3K ep:90 epch:0.16 loss:1.408 grdn:1.101 \
lr:1.0e-03 updt_s:0.101 data_s:0.001 smp/s:314 pick_accuracy:0.446 place_accuracy:0.152
"""


@pytest.fixture
def run(tmp_path):
    return TrainingRun(tmp_path / "train")


def test_a_run_starts_with_the_recipe_and_its_options(run, lerobot_train):
    fake = lerobot_train(20)
    run.train(RECIPE, OPTIONS, log_freq=1)
    assert fake.calls == [
        [
            f"--config_path={recipe_file(RECIPE)}",
            *OPTIONS,
            "--log_freq=1",
            f"--output_dir={run.folder}",
        ]
    ]
    assert run.is_finished


def test_a_finished_run_is_not_trained_again(run, lerobot_train):
    fake = lerobot_train(20)
    for _ in range(2):
        run.train(RECIPE, OPTIONS)
    assert len(fake.calls) == 1


def test_a_run_that_was_stopped_resumes_from_its_checkpoint(run, lerobot_train):
    lerobot_train(5)
    run.train(RECIPE, OPTIONS)
    assert not run.is_finished
    fake = lerobot_train(20)
    run.train(RECIPE, OPTIONS)
    assert fake.calls[0][:2] == [f"--config_path={run.config_file}", "--resume=true"]


def test_a_run_that_was_stopped_before_its_first_checkpoint_starts_anew(run, lerobot_train):
    lerobot_train(20)
    run.train(RECIPE, OPTIONS)
    shutil.rmtree(run.folder / "checkpoints")
    (run.folder / "left").touch()
    run.train(RECIPE, OPTIONS)
    assert not (run.folder / "left").exists()


def test_a_run_that_starts_anew_has_a_log_of_its_own(run, lerobot_train):
    lerobot_train(20)
    run.train(RECIPE, OPTIONS)
    shutil.rmtree(run.folder)
    run.train(RECIPE, OPTIONS)
    assert run.log.read_text() == LINE.format(20)


def test_a_run_that_resumes_appends_to_its_log(run, lerobot_train):
    lerobot_train(5)
    run.train(RECIPE, OPTIONS)
    lerobot_train(20)
    run.train(RECIPE, OPTIONS)
    assert run.log.read_text() == LINE.format(5) + LINE.format(20)


def test_a_run_of_another_program_is_left_alone(run, lerobot_train):
    fake = lerobot_train(20)
    run.folder.mkdir()
    (run.folder / "theirs").touch()
    with pytest.raises(ValueError, match="another program; let it finish or delete it"):
        run.train(RECIPE, OPTIONS)
    assert (run.folder / "theirs").exists()
    assert not fake.calls


def test_a_run_with_other_settings_is_refused(run, lerobot_train):
    lerobot_train(20)
    run.train(RECIPE, OPTIONS)
    with pytest.raises(ValueError, match="delete it or move it elsewhere"):
        run.train(RECIPE, [*OPTIONS, "--policy.rounds=1"])


def test_a_comment_in_the_recipe_is_no_other_setting(tmp_path, run, lerobot_train, monkeypatch):
    lerobot_train(20)
    run.train(RECIPE, OPTIONS)
    commented = tmp_path / "commented.yaml"
    commented.write_text(f"# A reason.\n\n{recipe_file(RECIPE).read_text()}")
    monkeypatch.setattr(module, "recipe_file", lambda name: commented)
    run.train(RECIPE, OPTIONS)


def test_a_run_that_two_ask_for_at_once_is_trained_once(run, lerobot_train):
    fake = lerobot_train(20)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: run.train(RECIPE, OPTIONS), range(4)))
    assert len(fake.calls) == 1


def test_steps_that_were_trained_twice_count_once_in_the_seconds(run):
    run.log.write_text("".join(LINE.format(n) for n in (1, 2, 3, 2, 3, 4)))
    assert 4 * run.seconds_per_step() == 2


def test_the_log_of_lerobot_train_is_read(run):
    run.log.write_text(LOG)
    assert run.log_entries() == [
        LogEntry(loss=2.107, pick_accuracy=0.271, place_accuracy=0.083),
        LogEntry(loss=1.408, pick_accuracy=0.446, place_accuracy=0.152),
    ]


@pytest.mark.lerobot
def test_a_failed_training_names_its_log(tmp_path, run, monkeypatch):
    broken = tmp_path / "broken.yaml"
    broken.write_text("nonsense: 1\n")
    monkeypatch.setattr(module, "recipe_file", lambda recipe: broken)
    with pytest.raises(OSError, match=r"train\.log says why"):
        run.train(RECIPE)
    assert "nonsense" in run.log.read_text()

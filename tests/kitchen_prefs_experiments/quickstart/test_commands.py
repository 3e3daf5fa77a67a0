"""The command `quickstart`: its training."""

import pytest

from kitchen_prefs_experiments import lerobot_train as lerobot_train_module
from kitchen_prefs_experiments.lerobot_train import TrainingRun
from kitchen_prefs_experiments.quickstart.commands import RECIPE, _train
from kitchen_prefs_experiments.recipes import recipe_file


def test_a_training_that_was_stopped_starts_anew(tmp_path, lerobot_train):
    run = TrainingRun(tmp_path / "run")
    run.folder.mkdir()
    (run.folder / "left").touch()
    fake = lerobot_train(1000)
    _train(run)
    assert not (run.folder / "left").exists()
    assert fake.calls == [[f"--config_path={recipe_file(RECIPE)}", f"--output_dir={run.folder}"]]


def test_a_finished_training_is_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(lerobot_train_module, "run_module", pytest.fail)
    monkeypatch.setattr(TrainingRun, "is_finished", True)
    _train(TrainingRun(tmp_path / "run"))

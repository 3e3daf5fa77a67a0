"""A lerobot-train that takes no time, and data sets in a folder of the test's own."""

import json
from pathlib import Path

import pytest

from kitchen_prefs_experiments import lerobot_train as lerobot_train_module

LOG_LINE = "INFO 2026-01-01 00:00:00 step:{} loss:2.1 updt_s:0.400 data_s:0.100 smp/s:310\n"


class FakeTraining:
    """Stands in for lerobot-train: keeps its arguments, and stops after some steps."""

    def __init__(self, steps):
        self.steps = steps
        self.calls = []

    def __call__(self, module, arguments, log, title):
        self.calls.append(list(arguments))
        options = dict(argument.lstrip("-").split("=", 1) for argument in arguments)
        checkpoint = Path(options["output_dir"]) / "checkpoints" / "last"
        (checkpoint / "pretrained_model").mkdir(parents=True, exist_ok=True)
        (checkpoint / "training_state").mkdir(exist_ok=True)
        step = json.dumps({"step": self.steps})
        (checkpoint / "training_state" / "training_step.json").write_text(step)
        if "steps" in options:
            config = json.dumps({"steps": int(options["steps"])})
            (checkpoint / "pretrained_model" / "train_config.json").write_text(config)
        with log.open("a") as file:
            file.write(LOG_LINE.format(self.steps))


@pytest.fixture
def lerobot_train(monkeypatch):
    """Lets trainings stop after some steps; gives the fake that took the place of the process."""

    def stopping_after(steps):
        fake = FakeTraining(steps)
        monkeypatch.setattr(lerobot_train_module, "run_module", fake)
        return fake

    return stopping_after


@pytest.fixture
def home(tmp_path, monkeypatch):
    """The folder of data sets that are made."""
    for name, value in (("HF_LEROBOT_HOME", tmp_path), ("HF_DATASETS_CACHE", tmp_path / "cache")):
        monkeypatch.setenv(name, str(value))
    return tmp_path

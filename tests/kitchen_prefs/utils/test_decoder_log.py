"""A video decoder that cannot be loaded is one sentence at most."""

import os
import subprocess
import sys

import pytest

from kitchen_prefs.datasets import make_dataset

SMALL = "dishwasher-train-p1-d1-v1"
CHOOSE = """
from lerobot.utils.import_utils import get_safe_default_video_backend, register_third_party_plugins
register_third_party_plugins()
assert get_safe_default_video_backend() == get_safe_default_video_backend() == "pyav"
"""
LOAD = f"import kitchen_prefs; print(kitchen_prefs.load_dataset({SMALL!r})[0]['task'])"


@pytest.fixture
def run(tmp_path):
    """Runs Python where torchcodec cannot be loaded, as without FFmpeg."""
    (tmp_path / "torchcodec.py").write_text("raise RuntimeError('Traceback ...\\n' * 100)\n")

    def run(code):
        path = {"PYTHONPATH": str(tmp_path), "HF_LEROBOT_HOME": str(tmp_path)}
        done = subprocess.run(
            [sys.executable, "-c", code],
            env=os.environ | path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done

    return run


@pytest.mark.lerobot
def test_lerobot_train_logs_one_sentence(run):
    said = run(CHOOSE).stderr
    assert "Traceback" not in said
    assert said.count("torchcodec cannot be loaded") == 1


@pytest.mark.lerobot
def test_loading_a_data_set_logs_nothing(run, tmp_path, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    make_dataset(SMALL)
    assert "torchcodec" not in run(LOAD).stderr

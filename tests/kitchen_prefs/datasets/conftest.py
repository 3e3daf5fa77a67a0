"""An empty home for data sets, and a home with a small one."""

import pytest

from kitchen_prefs.datasets import make_dataset

SMALL = "dishwasher-train-p2-d2-v1"


@pytest.fixture
def home(tmp_path, monkeypatch):
    """An empty home for data sets."""
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    monkeypatch.setattr("datasets.config.HF_DATASETS_CACHE", tmp_path / "cache")
    return tmp_path


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A home with one small data set, not to be changed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(tmp_path_factory.mktemp("home")))
        yield make_dataset(SMALL)

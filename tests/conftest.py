"""What all tests share: a hub, what is made once a run, and the order: the slow ones first."""

import os
import shutil

import pytest
from filelock import FileLock
from hub_server import running_hub
from short_splits import short_splits

os.environ.setdefault("OMP_NUM_THREADS", "1")  # for torch


def pytest_collection_modifyitems(items):
    """Put the slow tests first, so that none is left for the end."""
    items.sort(key=lambda item: item.get_closest_marker("slow") is None)


@pytest.fixture(scope="session")
def made_once(tmp_path_factory, worker_id):
    """Makes a folder once a run; the other workers wait for it."""
    alone = worker_id == "master"
    base = tmp_path_factory.getbasetemp()
    shared = base if alone else base.parent

    def make(name, fill):
        folder, made = shared / name, shared / f"{name}.made"
        with FileLock(shared / f"{name}.lock"):
            if not made.exists():
                shutil.rmtree(folder, ignore_errors=True)
                folder.mkdir()
                fill(folder)
                made.touch()
        return folder

    return make


@pytest.fixture
def few_sessions():
    """Cuts the splits of evaluations down to six sessions."""
    with short_splits():
        yield


@pytest.fixture
def hub(tmp_path):
    """A Hugging Face hub of one's own, empty."""
    with running_hub(tmp_path / "hub") as hub:
        yield hub

"""What all tests share: a hub, what is made once a run, and the order: the longest files first."""

import os
import shutil
from collections import Counter

import pytest
from filelock import FileLock
from hub_server import running_hub

os.environ.setdefault("OMP_NUM_THREADS", "1")  # for torch


def pytest_collection_modifyitems(items):
    """Put the files with the most slow tests first, so that none is left for the end."""
    slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
    items.sort(key=lambda item: -slow[item.path])


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
def hub(tmp_path):
    """A Hugging Face hub of one's own, empty."""
    with running_hub(tmp_path / "hub") as hub:
        yield hub

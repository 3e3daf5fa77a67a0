"""A hub for all tests, and how the processes share the cores: the longest files first."""

import os
from collections import Counter

import pytest
from hub_server import running_hub

os.environ.setdefault("OMP_NUM_THREADS", "1")  # for torch


def pytest_collection_modifyitems(items):
    """Put the files with the most slow tests first, so that none is left for the end."""
    slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
    items.sort(key=lambda item: -slow[item.path])


@pytest.fixture
def hub(tmp_path):
    """A Hugging Face hub of one's own, empty."""
    with running_hub(tmp_path / "hub") as hub:
        yield hub

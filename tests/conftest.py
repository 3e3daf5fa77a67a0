"""How the test processes share the cores: a thread each for torch, the longest files first."""

import os
from collections import Counter

os.environ.setdefault("OMP_NUM_THREADS", "1")


def pytest_collection_modifyitems(items):
    """Put the files with the most slow tests first, so that none is left for the end."""
    slow = Counter(item.path for item in items if item.get_closest_marker("slow"))
    items.sort(key=lambda item: -slow[item.path])

"""The files are those that LeRobot's own writer would write."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.datasets.columns import (
    FPS,
    ROBOT_TYPE,
    SETS,
    columns_of,
    features_of,
    read_columns,
)
from kitchen_prefs.datasets.names import content_of
from kitchen_prefs.envs.demonstrations import demonstrate
from kitchen_prefs.envs.people_demonstrations import demonstrate_people
from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.simulation.sessions import make_session

pytestmark = pytest.mark.xdist_group("writing")  # one fixture of the module serves all

SMALL = "dishwasher-train-p2-d2-v1"
DEMONSTRATE = {
    SMALL: lambda *session: demonstrate(make_session(*session)),
    "dishwasher-people_train-u2-v2": lambda *session: demonstrate_people(
        make_people_session(*session)
    ),
}


def test_the_files_do_not_depend_on_the_number_of_workers(small, home):
    alone = make_dataset(SMALL, workers=1)
    assert alone != small
    assert _contents(alone) == _contents(small)


@pytest.mark.parametrize("name", DEMONSTRATE)
def test_lerobots_own_writer_would_write_the_same_and_statistics_of_the_sets(name, home):
    from lerobot.datasets import LeRobotDataset

    small, features = make_dataset(name), features_of(name)
    written = LeRobotDataset.create(
        "kitchen_prefs/by_lerobot", FPS, features, home / "by_lerobot", ROBOT_TYPE, use_videos=False
    )
    for session in content_of(name).sessions:
        demonstration = DEMONSTRATE[name](*session)
        columns = columns_of(demonstration)
        for frame in range(len(columns["action"])):
            values = {name: np.atleast_1d(column[frame]) for name, column in columns.items()}
            written.add_frame(values | {"task": demonstration.task})
        written.save_episode()
    written.finalize()

    for file in ("meta/info.json", "meta/stats.json"):
        ours, lerobots = (json.loads((root / file).read_text()) for root in (small, written.root))
        if file == "meta/stats.json":
            lerobots.pop(SETS)
        assert _approximately(ours) == lerobots
    for file in ("meta/tasks.parquet", "meta/episodes/chunk-000/file-000.parquet"):
        ours, lerobots = (pd.read_parquet(root / file) for root in (small, written.root))
        lerobots = lerobots[[name for name in lerobots if not name.startswith(f"stats/{SETS}")]]
        pd.testing.assert_frame_equal(ours[sorted(ours)], lerobots[sorted(lerobots)])
    dataset = LeRobotDataset("kitchen_prefs/by_lerobot", root=written.root)
    ours = read_columns(small)
    for frame in (0, len(dataset) // 2, len(dataset) - 1):
        for name, column in ours.items():
            values = column[frame].ravel() if name == SETS else column[frame]
            np.testing.assert_array_equal(dataset[frame][name].numpy(), values)


def _approximately(tree):
    """Numbers within rounding, as pooling all episodes at once rounds otherwise than one by one."""
    if isinstance(tree, dict):
        return {key: _approximately(value) for key, value in tree.items()}
    if isinstance(tree, list) and tree and isinstance(tree[0], float):
        return pytest.approx(tree)
    return tree


def _contents(root: Path) -> dict[str, bytes]:
    files = (path for path in root.rglob("*") if path.is_file())
    return {str(path.relative_to(root)): path.read_bytes() for path in files}

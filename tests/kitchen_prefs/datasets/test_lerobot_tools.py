"""LeRobot's own tools on our data sets, in chains, as docs/lerobot_tools.md lists them."""

import json
import os

import numpy as np
import pyarrow.parquet as pq
import pytest
import warm_python
from lerobot.datasets import LeRobotDataset, StreamingLeRobotDataset

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.instances import FLAT_SIZE

NAME = "kitchen_prefs/dishwasher-train-p2-d3-v1"  # six episodes
DELETE = ["--operation.type=delete_episodes", "--operation.episode_indices=[0, 3]"]
SPLIT = ["--operation.type=split", '--operation.splits={"first": 0.5, "second": 0.5}']
MERGE = ["--operation.type=merge", "--operation.repo_ids=['own/four_second', 'own/four_first']"]
REMOVE = ["--operation.type=remove_feature", "--operation.feature_names=['next.reward']"]
STATS = ["--operation.type=recompute_stats", "--operation.overwrite=true"]
TASKS = ["--operation.type=modify_tasks", "--operation.new_task=load it"]
# Each works on what the one before has left.
CHAIN = [
    [f"--repo_id={NAME}", "--new_repo_id=own/four", *DELETE],
    ["--repo_id=own/four", *SPLIT],
    ["--new_repo_id=own/merged", *MERGE],
    ["--repo_id=own/merged", "--new_repo_id=own/slim", *REMOVE],
    ["--repo_id=own/slim", *STATS],
    ["--repo_id=own/slim", *TASKS],
    ["--repo_id=own/slim", *DELETE[:1], "--operation.episode_indices=[1]"],  # in place
]
# One process, because LeRobot takes seconds to start.
EDIT_ALL = """
import json
import sys

from lerobot.scripts.lerobot_edit_dataset import main

for arguments in json.loads(sys.argv[1]):
    sys.argv[1:] = arguments
    main()
"""

pytestmark = [pytest.mark.lerobot, pytest.mark.slow]


@pytest.fixture(scope="session")
def edited(made_once):
    """A home with a data set of ours and what LeRobot's tools made of it."""

    def fill(home):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("HF_LEROBOT_HOME", str(home))
            make_dataset(NAME)
        environment = {"HF_LEROBOT_HOME": str(home), "HF_HUB_OFFLINE": "1"}
        environment |= {"HF_DATASETS_CACHE": str(home / "cache")}
        done = warm_python.run("-c", EDIT_ALL, json.dumps(CHAIN), env=os.environ | environment)
        assert done.returncode == 0, done.stderr[-3000:]

    return made_once("edited", fill)


def frames_of(root):
    (file,) = root.glob("data/*/*.parquet")
    return pq.read_table(file)


def sets_of(table):
    return np.stack(table["observation.instances"].to_numpy())


def test_episodes_are_deleted_split_and_merged_and_features_removed(edited):
    before = frames_of(edited / NAME)
    episode = before["episode_index"].to_numpy()
    merged = frames_of(edited / "own/merged")
    expected = np.concatenate([sets_of(before)[episode == i] for i in (4, 5, 1, 2)])
    np.testing.assert_array_equal(sets_of(merged), expected)
    after = frames_of(edited / "own/slim")
    assert "next.reward" in before.column_names
    assert "next.reward" not in after.column_names
    assert len(set(after["episode_index"].to_pylist())) == 3
    (task,) = pq.read_table(edited / "own/slim/meta/tasks.parquet")["task"].to_pylist()
    assert task == "load it"


def test_what_the_tools_made_is_loaded_in_part_and_by_several_workers(edited):
    dataset = LeRobotDataset("own/merged", root=edited / "own/merged", episodes=[1, 3])
    import torch

    loader = torch.utils.data.DataLoader(dataset, batch_size=8, num_workers=2)
    batches = list(loader)
    assert {int(e) for batch in batches for e in batch["episode_index"]} == {1, 3}
    assert all(batch["observation.instances"].shape[1:] == (FLAT_SIZE,) for batch in batches)


def test_a_data_set_streams(edited):
    dataset = StreamingLeRobotDataset(NAME, root=edited / NAME, shuffle=False)
    sets = {frame["observation.instances"].numpy().tobytes() for frame in dataset}
    assert sets == {row.tobytes() for row in sets_of(frames_of(edited / NAME))}

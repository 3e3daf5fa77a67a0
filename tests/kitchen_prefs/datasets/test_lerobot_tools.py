"""LeRobot's own tools on our data sets, in chains, as docs/lerobot_tools.md lists them."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
import torch
import warm_python
from lerobot.datasets import LeRobotDataset, StreamingLeRobotDataset
from lerobot.scripts import lerobot_dataset_viz
from lerobot.utils.import_utils import is_package_available

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.datasets.drawing import DRAWING, draw_dataset
from kitchen_prefs.instances import FLAT_SIZE

ROOT = Path(__file__).parents[3]
NAME = "kitchen_prefs/dishwasher-train-p2-d3-v1"  # six episodes
PEOPLE = "kitchen_prefs/dishwasher-people_train-u3-v2"  # six, too
DELETE = ["--operation.type=delete_episodes", "--operation.episode_indices=[0, 3]"]
SPLIT = ["--operation.type=split", '--operation.splits={"first": 0.5, "second": 0.5}']
REMOVE = ["--operation.type=remove_feature", "--operation.feature_names=['next.reward']"]
STATS = ["--operation.type=recompute_stats", "--operation.overwrite=true"]
TASKS = ["--operation.type=modify_tasks", "--operation.new_task=load it"]


def chain(name, own):
    """Each works on what the one before has left; `own` is where copies lie."""
    parts = f"['{own}/four_second', '{own}/four_first']"
    return [
        [f"--repo_id={name}", f"--new_repo_id={own}/four", *DELETE],
        [f"--repo_id={own}/four", *SPLIT],
        [f"--new_repo_id={own}/merged", "--operation.type=merge", f"--operation.repo_ids={parts}"],
        [f"--repo_id={own}/merged", f"--new_repo_id={own}/slim", *REMOVE],
        [f"--repo_id={own}/slim", *STATS],
        [f"--repo_id={own}/slim", *TASKS],
        [f"--repo_id={own}/slim", *DELETE[:1], "--operation.episode_indices=[1]"],  # in place
    ]


CHAINS = [*chain(NAME, "own"), *chain(PEOPLE, "people")]
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
            make_dataset(PEOPLE)
        environment = {"HF_LEROBOT_HOME": str(home), "HF_HUB_OFFLINE": "1"}
        environment |= {"HF_DATASETS_CACHE": str(home / "cache")}
        done = warm_python.run("-c", EDIT_ALL, json.dumps(CHAINS), env=os.environ | environment)
        assert done.returncode == 0, done.stderr[-3000:]

    return made_once("edited", fill)


def frames_of(root):
    (file,) = root.glob("data/*/*.parquet")
    return pq.read_table(file)


def sets_of(table):
    return np.stack(table["observation.instances"].to_numpy())


@pytest.mark.parametrize(("name", "own"), [(NAME, "own"), (PEOPLE, "people")])
def test_episodes_are_deleted_split_and_merged_and_features_removed(edited, name, own):
    before = frames_of(edited / name)
    episode = before["episode_index"].to_numpy()
    merged = frames_of(edited / own / "merged")
    expected = np.concatenate([sets_of(before)[episode == i] for i in (4, 5, 1, 2)])
    np.testing.assert_array_equal(sets_of(merged), expected)
    after = frames_of(edited / own / "slim")
    assert "next.reward" in before.column_names
    assert "next.reward" not in after.column_names
    assert len(set(after["episode_index"].to_pylist())) == 3
    (task,) = pq.read_table(edited / own / "slim/meta/tasks.parquet")["task"].to_pylist()
    assert task == "load it"


def test_what_the_tools_made_is_loaded_in_part_and_by_several_workers(edited):
    dataset = LeRobotDataset("own/merged", root=edited / "own/merged", episodes=[1, 3])
    loader = torch.utils.data.DataLoader(dataset, batch_size=8, num_workers=2)
    batches = list(loader)
    assert {int(e) for batch in batches for e in batch["episode_index"]} == {1, 3}
    assert all(batch["observation.instances"].shape[1:] == (FLAT_SIZE,) for batch in batches)


def test_a_data_set_streams_through_a_worker(edited):
    dataset = StreamingLeRobotDataset(NAME, root=edited / NAME, max_num_shards=1)
    loader = torch.utils.data.DataLoader(dataset, batch_size=8, num_workers=1)
    streamed = {row.numpy().tobytes() for batch in loader for row in batch["observation.instances"]}
    assert streamed == {row.tobytes() for row in sets_of(frames_of(edited / NAME))}


def through(lines, words):
    """The lines up to the first that holds some words."""
    for line in lines:
        yield line
        if words in line:
            return


def test_two_processes_train_and_log_to_wandb_offline(edited, tmp_path):
    launch = [sys.executable, "-m", "accelerate.commands.launch", "--multi_gpu"]
    command = [
        *(*launch, "--num_processes=2", "-m", "lerobot.scripts.lerobot_train"),
        f"--config_path={ROOT / 'policies/recipes/ttp_quick.yaml'}",
        *(f"--dataset.repo_id={NAME}", f"--output_dir={tmp_path / 'run'}"),
        *("--steps=2", "--save_freq=2", "--log_freq=1", "--batch_size=4", "--num_workers=0"),
        *("--wandb.enable=true", "--wandb.mode=offline"),
    ]
    environment = os.environ | {"HF_LEROBOT_HOME": str(edited), "HF_HUB_OFFLINE": "1"}
    pipe = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True}
    with subprocess.Popen(command, env=environment, **pipe) as process:
        printed = "".join(through(process.stdout, "End of training"))
        try:
            process.wait(timeout=30)
        except subprocess.TimeoutExpired:  # two of 34 runs did not leave torch's process group
            process.terminate()
    assert "End of training" in printed, printed[-3000:]
    assert "Effective batch size: 4 x 2 = 8" in printed
    (log,) = tmp_path.glob("run/wandb/offline-run-*/run-*.wandb")
    assert b"pick_accuracy" in log.read_bytes()


@pytest.fixture(scope="session")
def drawn(made_once):
    """A data set of one episode with a drawing in each frame."""

    def fill(home):
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("HF_LEROBOT_HOME", str(home))
            draw_dataset(NAME, [4])

    return made_once("drawn", fill)


def test_a_drawn_data_set_is_the_original_with_pictures(drawn):
    original = LeRobotDataset(NAME, root=drawn / NAME, episodes=[4])
    copy = LeRobotDataset(f"{NAME}-drawn", root=drawn / f"{NAME}-drawn")
    assert len(copy) == len(original)
    renumbered = ("episode_index", "index", "task_index")
    for before, after in zip(original, copy, strict=True):
        assert before["task"] == after["task"]
        for name in before.keys() - {*renumbered, "task"}:
            torch.testing.assert_close(after[name], before[name], rtol=0, atol=0)
        assert after[DRAWING].shape == (3, 480, 640)
    assert set(copy.meta.stats[DRAWING]) >= {"min", "max", "mean", "std"}
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(drawn))
        with pytest.raises(ValueError, match="is there already; delete the folder"):
            draw_dataset(NAME, [0])
        with pytest.raises(ValueError, match="no episode 6; its episodes are 0 to 5"):
            draw_dataset(NAME, [0, 6])


@pytest.mark.skipif(not is_package_available("rerun-sdk", "rerun"), reason="needs the extra viz")
def test_the_viewer_shows_each_drawing(drawn, tmp_path, monkeypatch):
    import rerun
    from rerun.experimental import RrdReader

    name, root = f"{NAME}-drawn", drawn / f"{NAME}-drawn"
    arguments = [f"--repo-id={name}", f"--root={root}", "--episode-index=0", "--num-workers=0"]
    save = ["--save=1", f"--output-dir={tmp_path}"]
    monkeypatch.setattr(sys, "argv", ["lerobot-dataset-viz", *arguments, *save])
    lerobot_dataset_viz.main()
    rerun.disconnect()  # the file is whole once the process lets go of it

    (file,) = tmp_path.glob("*.rrd")
    batches = [chunk.to_record_batch() for chunk in RrdReader(file).store().stream().to_chunks()]
    buffers = [batch["Image:buffer"] for batch in batches if "Image:buffer" in batch.schema.names]
    shown = np.concatenate([buffer.flatten().flatten().to_numpy() for buffer in buffers])
    drawings = [(frame[DRAWING] * 255).byte() for frame in LeRobotDataset(name, root=root)]
    expected = torch.stack(drawings).permute(0, 2, 3, 1).numpy()  # (T, H, W, 3)
    np.testing.assert_array_equal(shown, expected.ravel())

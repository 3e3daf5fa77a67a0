"""Data sets are made on demand and loaded."""

import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import torch

import kitchen_prefs
from kitchen_prefs import instances
from kitchen_prefs.datasets import dataset_root, load_dataset, make_dataset
from kitchen_prefs.datasets.verification import verify_dataset

pytestmark = pytest.mark.xdist_group("loading")  # one fixture of the module serves all

SMALL = "dishwasher-train-p2-d2-v1"
LARGE = "dishwasher-train-p7-d9-v1"  # takes a second or two to make


def test_a_single_demonstration_is_made_and_verified(home):
    name = "dishwasher-prompts-of9-d1-v1"
    dataset = load_dataset(name)
    assert dataset.num_episodes == 1
    assert {int(label) for label in dataset.hf_dataset["preference"]} == {8}
    assert "reach PE 1 and ED 1" in list(verify_dataset(name))[-1]


def test_a_loaded_data_set_holds_demonstrations(small, home, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(small.parent.parent))
    dataset = kitchen_prefs.load_dataset(SMALL)
    assert dataset.num_episodes == 4
    loader = torch.utils.data.DataLoader(dataset, batch_size=16)
    batch = next(iter(loader))
    sets = batch["observation.instances"]
    assert sets.shape == (16, instances.FLAT_SIZE)
    rows = instances.as_rows(sets)[torch.arange(16), batch["chosen_index"]]
    torch.testing.assert_close(rows[:, instances.POSE], batch["action"], rtol=0, atol=0)
    assert batch["preference"].tolist() == [0] * 16
    assert batch["task"][0].startswith("Load the top rack with cups")
    last = dataset[dataset.meta.episodes[0]["dataset_to_index"] - 1]
    assert last["next.done"]
    assert last["next.success"]


@pytest.mark.lerobot
def test_plain_lerobot_reads_it_without_this_package(small, tmp_path):
    program = (
        "import sys\n"
        "from lerobot.datasets import LeRobotDataset\n"
        f"dataset = LeRobotDataset('kitchen_prefs/{SMALL}')\n"
        "assert 'kitchen_prefs' not in sys.modules\n"
        "print(dataset.num_episodes, dataset[0]['observation.instances'].shape)\n"
    )
    environment = {
        **os.environ,
        "HF_HUB_OFFLINE": "1",
        "HF_LEROBOT_HOME": str(small.parent.parent),
        "HF_DATASETS_CACHE": str(tmp_path),
    }
    done = subprocess.run(
        [sys.executable, "-c", program],
        check=False,
        env=environment,
        cwd="/",
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == "4 torch.Size([936])\n"


@pytest.mark.lerobot
def test_lerobot_merges_data_sets(small, home, monkeypatch):
    from lerobot.datasets import merge_datasets

    monkeypatch.setenv("HF_LEROBOT_HOME", str(small.parent.parent))
    dataset = load_dataset(SMALL)
    merged = merge_datasets([dataset, dataset], "kitchen_prefs/merged", home / "merged")
    assert merged.num_episodes == 2 * dataset.num_episodes
    first, second = merged[0], merged[len(dataset)]
    assert torch.equal(first["observation.instances"], second["observation.instances"])


def test_a_data_set_that_differs_from_the_published_one_is_told(home, monkeypatch):
    monkeypatch.setattr("kitchen_prefs.datasets.loading.published_fingerprint", lambda name: "0")
    with pytest.warns(UserWarning, match="differs from the published one"):
        make_dataset(SMALL)


def test_a_full_disk_leaves_nothing_behind(home):
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, limits[1]))
    try:
        with pytest.raises(OSError, match=r"could not be made in .*; make room"):
            make_dataset(SMALL)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert [path for path in _made(home) if path.suffix != ".lock"] == []


def test_a_home_that_cannot_be_written_is_told(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path / "file"))
    with pytest.raises(OSError, match="HF_LEROBOT_HOME"):
        make_dataset(SMALL)


@pytest.mark.lerobot
def test_two_processes_that_ask_at_once_share_one_data_set(home):
    both = [_make_elsewhere(SMALL, home) for _ in range(2)]
    for process in both:
        output, errors = process.communicate(timeout=120)
        assert process.returncode == 0, errors
        assert output == f"{SMALL} is in {dataset_root(SMALL)}\n"
    assert load_dataset(SMALL).num_episodes == 4


@pytest.mark.lerobot
def test_a_script_that_has_used_torchs_threads_makes_a_data_set(home):
    """The workers are forked from a process with threads, and the script has no main guard."""
    script = home / "script.py"
    script.write_text(
        "import torch\n"
        "torch.set_num_threads(4)\n"
        "weight = torch.ones(500, 500, requires_grad=True)\n"
        "(weight @ weight).sum().backward()\n"
        "from kitchen_prefs import load_dataset\n"
        f"dataset = load_dataset('{SMALL}')\n"
        "assert torch.equal(weight.grad, torch.full((500, 500), 1000.0))\n"
        "print(dataset.num_episodes)\n"
    )
    done = subprocess.run(
        [sys.executable, script],
        check=False,
        env={**os.environ, "HF_LEROBOT_HOME": str(home), "HF_DATASETS_CACHE": str(home / "cache")},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == "4\n"


@pytest.mark.lerobot
def test_after_a_kill_the_data_set_is_made_anew(home):
    process = _make_elsewhere(LARGE, home)
    unfinished = dataset_root(LARGE).with_name(f".unfinished-{LARGE}")
    while not unfinished.exists():
        assert process.poll() is None
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert unfinished.exists()
    assert make_dataset(LARGE).exists()
    assert not unfinished.exists()


def _make_elsewhere(name: str, home: Path) -> subprocess.Popen:
    return subprocess.Popen(
        [sys.executable, "-m", "kitchen_prefs.cli", "datasets", "make", name],
        env={**os.environ, "HF_LEROBOT_HOME": str(home)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def _made(home: Path) -> list[Path]:
    return list((home / "kitchen_prefs").iterdir())

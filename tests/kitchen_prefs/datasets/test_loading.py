import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

import kitchen_prefs
from kitchen_prefs import instances
from kitchen_prefs.datasets import dataset_names, dataset_root, load_dataset, make_dataset
from kitchen_prefs.datasets.columns import FEATURES, FPS, ROBOT_TYPE, columns_of, read_columns
from kitchen_prefs.datasets.manifest import MANIFEST, published_fingerprint
from kitchen_prefs.datasets.names import content_of
from kitchen_prefs.datasets.verification import CHECKS, verify_dataset
from kitchen_prefs.envs.demonstrations import demonstrate
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import DATA_VERSION, SPLITS

pytestmark = pytest.mark.xdist_group("loading")  # one fixture of the module serves all

SMALL = "dishwasher-train-p2-d2-v1"
LARGE = "dishwasher-train-p7-d9-v1"  # takes a second or two to make


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    monkeypatch.setattr("datasets.config.HF_DATASETS_CACHE", tmp_path / "cache")
    return tmp_path


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A home with one small data set, not to be changed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(tmp_path_factory.mktemp("home")))
        yield make_dataset(SMALL)


def test_there_is_one_data_set_a_split_and_one_with_all_twelve():
    sizes = {name: len(content_of(name).sessions) for name in kitchen_prefs.dataset_names()}
    expected = {f"dishwasher-{s.name}-v{DATA_VERSION}": s.sessions for s in SPLITS.values()}
    assert sizes == expected | {f"dishwasher-train-all-v{DATA_VERSION}": 12 * 80}


def test_all_twelve_preferences_are_equally_frequent_in_train_all():
    sessions = content_of("dishwasher-train-all-v1").sessions
    users = [SPLITS[split].users[index] for split, index in sessions]
    assert np.bincount(users).tolist() == [80] * 12


@given(st.integers(1, 7), st.integers(1, 80))
def test_a_subset_has_the_first_preferences_with_the_same_number_of_demonstrations(p, d):
    sessions = content_of(f"dishwasher-train-p{p}-d{d}-v1").sessions
    assert {split for split, _ in sessions} == {"train"}
    users = [SPLITS["train"].users[index] for _, index in sessions]
    assert np.bincount(users).tolist() == [d] * p
    assert len(set(sessions)) == len(sessions)


@given(st.integers(8, 12), st.integers(1, 80))
def test_a_subset_of_prompts_has_the_first_demonstrations_of_one_held_out_preference(number, d):
    sessions = content_of(f"dishwasher-prompts-of{number}-d{d}-v1").sessions
    first = [i for i, user in enumerate(SPLITS["prompts"].users) if user == number - 1][:d]
    assert list(sessions) == [("prompts", i) for i in first]


def test_a_single_demonstration_is_made_and_verified(home):
    name = "dishwasher-prompts-of9-d1-v1"
    dataset = load_dataset(name)
    assert dataset.num_episodes == 1
    assert {int(label) for label in dataset.hf_dataset["preference"]} == {8}
    assert len(list(verify_dataset(name))) == 1 + len(CHECKS)


@pytest.mark.parametrize(
    "name",
    [
        "dishwasher-train",
        "dishwasher-prompts-of7-d1-v1",
        "dishwasher-prompts-of13-d1-v1",
        "dishwasher-prompts-of8-d0-v1",
        "dishwasher-prompts-of8-d81-v1",
        "dishwasher-prompts-p1-d1-v1",
        "dishwasher-train-p8-d1-v1",
        "dishwasher-train-p0-d1-v1",
        "dishwasher-train-p1-d0-v1",
        "dishwasher-train-p1-d81-v1",
        "dishwasher-train-p01-d1-v1",
        "dishwasher-val-p1-d1-v1",
        "other/dishwasher-train-v1",
        "../dishwasher-train-v1",
        "",
    ],
)
def test_a_name_outside_the_grammar_is_refused(name, home):
    with pytest.raises(ValueError, match="There is no data set"):
        load_dataset(name)
    assert list(home.iterdir()) == []


def test_a_misspelt_name_is_answered_with_the_nearest():
    with pytest.raises(ValueError, match="Did you mean 'dishwasher-unseen_counts-v1'"):
        content_of("dishwasher-unseen-counts-v1")


def test_another_version_is_refused_with_the_one_that_exists():
    with pytest.raises(ValueError, match="ask for 'dishwasher-train-p2-d2-v1'"):
        content_of("dishwasher-train-p2-d2-v7")


def test_a_name_may_be_lerobots_repo_id():
    assert content_of(f"kitchen_prefs/{SMALL}") == content_of(SMALL)


def test_a_loaded_data_set_holds_demonstrations(small, home, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(small.parent.parent))
    dataset = kitchen_prefs.load_dataset(SMALL)
    assert dataset.num_episodes == 4
    loader = torch.utils.data.DataLoader(dataset, batch_size=16)
    batch = next(iter(loader))
    sets = batch["observation.instances"]
    assert sets.shape == (16, instances.CAPACITY, instances.COLUMNS)
    rows = sets[torch.arange(16), batch["chosen_index"]]
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
    assert done.stdout == "4 torch.Size([72, 13])\n"


@pytest.mark.lerobot
def test_lerobot_merges_data_sets(small, home, monkeypatch):
    from lerobot.datasets import merge_datasets

    monkeypatch.setenv("HF_LEROBOT_HOME", str(small.parent.parent))
    dataset = load_dataset(SMALL)
    merged = merge_datasets([dataset, dataset], "kitchen_prefs/merged", home / "merged")
    assert merged.num_episodes == 2 * dataset.num_episodes
    first, second = merged[0], merged[len(dataset)]
    assert torch.equal(first["observation.instances"], second["observation.instances"])


def test_the_files_do_not_depend_on_the_number_of_workers(small, home):
    alone = make_dataset(SMALL, workers=1)
    assert alone != small
    assert _contents(alone) == _contents(small)


def test_lerobots_own_writer_would_write_the_same(small, home):
    from lerobot.datasets import LeRobotDataset

    written = LeRobotDataset.create(
        "kitchen_prefs/by_lerobot", FPS, FEATURES, home / "by_lerobot", ROBOT_TYPE, use_videos=False
    )
    for session in content_of(SMALL).sessions:
        demonstration = demonstrate(make_session(*session))
        columns = columns_of(demonstration)
        for frame in range(len(columns["action"])):
            values = {name: np.atleast_1d(column[frame]) for name, column in columns.items()}
            written.add_frame(values | {"task": demonstration.task})
        written.save_episode()
    written.finalize()

    for file in ("meta/info.json", "meta/stats.json"):
        ours, lerobots = (json.loads((root / file).read_text()) for root in (small, written.root))
        assert _approximately(ours) == lerobots
    for file in ("meta/tasks.parquet", "meta/episodes/chunk-000/file-000.parquet"):
        ours, lerobots = (pd.read_parquet(root / file) for root in (small, written.root))
        pd.testing.assert_frame_equal(ours[sorted(ours)], lerobots[sorted(lerobots)])
    dataset = LeRobotDataset("kitchen_prefs/by_lerobot", root=written.root)
    ours = read_columns(small)
    for frame in (0, len(dataset) // 2, len(dataset) - 1):
        for name, column in ours.items():
            np.testing.assert_array_equal(dataset[frame][name].numpy(), column[frame])


@pytest.mark.parametrize("file", ["data/chunk-000/file-000.parquet", "meta/stats.json"])
def test_a_damaged_data_set_is_refused_and_kept(file, home):
    root = make_dataset(SMALL)
    content = bytearray((root / file).read_bytes())
    content[len(content) // 2] ^= 1
    (root / file).write_bytes(content)
    with pytest.raises(ValueError, match=rf"is damaged \({file}.*delete the folder"):
        load_dataset(SMALL)
    assert (root / file).read_bytes() == content


def test_a_data_set_that_lacks_a_file_is_refused(home):
    root = make_dataset(SMALL)
    (root / "meta" / "info.json").unlink()
    with pytest.raises(ValueError, match=r"is damaged \(meta/info\.json"):
        load_dataset(SMALL)


def test_a_half_written_data_set_is_refused(home):
    root = dataset_root(SMALL)
    (root / "meta").mkdir(parents=True)
    (root / "meta" / "info.json").write_text("{}")
    with pytest.raises(ValueError, match="is incomplete; delete the folder"):
        load_dataset(SMALL)


@pytest.mark.parametrize(
    "change",
    [
        {"files": ["data/chunk-000/file-000.parquet"]},
        {"fingerprint": None},
        {"episodes": "4"},
        {"data_version": None},
    ],
)
def test_a_damaged_manifest_is_refused(home, change):
    path = make_dataset(SMALL) / MANIFEST
    path.write_text(json.dumps(json.loads(path.read_text()) | change))
    with pytest.raises(ValueError, match=rf"is damaged \({MANIFEST} is not.*delete the folder"):
        load_dataset(SMALL)


@pytest.mark.parametrize("content", ["", "{", "[]", "null", "{}"])
def test_a_manifest_that_is_none_is_refused(home, content):
    (make_dataset(SMALL) / MANIFEST).write_text(content)
    with pytest.raises(ValueError, match=rf"is damaged \({MANIFEST} is not.*delete the folder"):
        load_dataset(SMALL)


def test_the_files_are_those_of_the_manifest(home):
    path = make_dataset(SMALL) / MANIFEST
    whole = path.read_text()
    path.write_text(json.dumps(json.loads(whole) | {"files": {}}))
    with pytest.raises(ValueError, match=r"is damaged \(data/chunk-000/file-000\.parquet"):
        load_dataset(SMALL)
    path.write_text(whole)
    (path.parents[1] / "data" / "chunk-000" / "file-001.parquet").touch()
    with pytest.raises(ValueError, match=r"is damaged \(data/chunk-000/file-001\.parquet"):
        load_dataset(SMALL)


def test_a_data_set_of_another_version_is_refused(home):
    root = make_dataset(SMALL)
    manifest = json.loads((root / MANIFEST).read_text())
    (root / MANIFEST).write_text(json.dumps(manifest | {"data_version": DATA_VERSION + 1}))
    with pytest.raises(ValueError, match=f"is of data version {DATA_VERSION + 1}.*delete"):
        load_dataset(SMALL)


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


def test_published_names_are_recorded_with_a_fingerprint():
    for name in dataset_names():
        assert len(published_fingerprint(name) or "") == 64
    assert published_fingerprint(SMALL) is None


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

import json

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from lerobot.datasets import aggregate_stats
from lerobot.datasets.compute_stats import compute_episode_stats

from kitchen_prefs.datasets import dataset_root, make_dataset
from kitchen_prefs.datasets.certificates import CERTIFICATES
from kitchen_prefs.datasets.columns import fingerprint, read_columns, read_tasks
from kitchen_prefs.datasets.manifest import write_manifest
from kitchen_prefs.datasets.verification import verify_dataset

SMALL = "dishwasher-train-p2-d1-v1"
OF_PEOPLE = "dishwasher-people_train-u1-v2"
NOISY = "dishwasher-noisy-v1"


@pytest.fixture
def root(tmp_path, monkeypatch):
    """A small data set to spoil."""
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    return make_dataset(SMALL)


@pytest.fixture
def root_of_people(tmp_path, monkeypatch):
    """A small data set of the second tier to spoil."""
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    return make_dataset(OF_PEOPLE)


@pytest.mark.parametrize(
    ("name", "perfect"), [(SMALL, "PE 1 and ED 1"), (OF_PEOPLE, "Where 1 and Turn 1")]
)
def test_a_data_set_that_was_made_here_is_right(name, perfect, home):
    make_dataset(name)
    claims = list(verify_dataset(name))
    assert any("fingerprint" in claim for claim in claims)
    assert any(perfect in claim for claim in claims)


@pytest.mark.parametrize(
    ("column", "frame", "value", "said"),
    [
        ("chosen_index", 2, 76, "outside the instance set"),
        ("preference", 5, 1, "episode 0 does not have the user"),
        ("next.reward", 0, 1, "the rewards of episode 0"),
    ],
)
def test_a_wrong_value_of_the_second_tier_is_found(root_of_people, column, frame, value, said):
    spoil(root_of_people, column, frame, value)
    write_manifest(OF_PEOPLE, root_of_people)
    with pytest.raises(ValueError, match=said):
        list(verify_dataset(OF_PEOPLE))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda numbers: numbers[:1], "1 certificates, not 2"),
        (lambda numbers: [numbers[0], numbers[1] - 0.01], "the certificate of episode 1"),
    ],
)
def test_a_wrong_certificate_is_found(root_of_people, change, said):
    path = root_of_people / CERTIFICATES
    certificates = json.loads(path.read_text())
    path.write_text(json.dumps({name: change(values) for name, values in certificates.items()}))
    write_manifest(OF_PEOPLE, root_of_people)
    with pytest.raises(ValueError, match=said):
        list(verify_dataset(OF_PEOPLE))


def test_a_data_set_that_is_not_there_is_told(root):
    with pytest.raises(ValueError, match="kitchen-prefs datasets make dishwasher-val-v1"):
        list(verify_dataset("dishwasher-val-v1"))


def test_a_changed_value_is_found_by_the_fingerprint(root):
    manifest = (root / "meta" / "kitchen_prefs.json").read_text()
    spoil(root, "next.reward", 0, 1)
    honest = write_manifest(SMALL, root)
    recorded = json.loads(manifest)["fingerprint"]
    manifest = honest | {"fingerprint": recorded}
    (root / "meta" / "kitchen_prefs.json").write_text(json.dumps(manifest))
    with pytest.raises(ValueError, match="its fingerprint is not the one"):
        list(verify_dataset(SMALL))


def test_a_data_set_other_than_the_published_one_is_found(root, monkeypatch):
    published = "kitchen_prefs.datasets.verification.published_fingerprint"
    monkeypatch.setattr(published, lambda name: "0" * 64)
    with pytest.raises(ValueError, match="differs from the published data set"):
        list(verify_dataset(SMALL))


@pytest.mark.parametrize(
    ("column", "frame", "value", "said"),
    [
        ("frame_index", 3, 5, "frame_index does not count up"),
        ("index", 3, 5, "index does not count up"),
        ("episode_index", 0, 1, "episode_index does not count up"),
        ("task_index", 0, 9, "a task index has no task"),
        ("action", 4, np.full(7, np.nan, np.float32), "holds NaN"),
        ("chosen_index", 2, 72, "outside the instance set"),
        ("chosen_index", 2, -1, "outside the instance set"),
        ("chosen_index", 2, 71, "may not choose"),
        ("action", 4, np.ones(7, np.float32), "action of frame 4 is not the pose"),
        ("preference", 5, 3, "episode 0 does not have the preference"),
        ("task_index", 5, 1, "task of episode 0 is not its preference"),
        ("timestamp", 3, 3.5, "a timestamp is not its frame's"),
        ("next.done", 3, True, "next.done is not true at just the last frames"),
        ("next.success", 3, True, "next.success is not true at just the last frames"),
        ("next.reward", 0, 1, "the rewards of episode 0"),
    ],
)
def test_a_wrong_value_is_found(root, column, frame, value, said):
    spoil(root, column, frame, value)
    write_manifest(SMALL, root)
    with pytest.raises(ValueError, match=said):
        list(verify_dataset(SMALL))


@pytest.mark.parametrize("kind", ["min", "max", "mean", "std", "q01", "q50", "q99"])
def test_wrong_statistics_are_found(root, kind):
    path = root / "meta" / "stats.json"
    stats = json.loads(path.read_text())
    stats["action"][kind][1] += 0.01
    path.write_text(json.dumps(stats))
    write_manifest(SMALL, root)
    with pytest.raises(ValueError, match=f"the recorded {kind} of the column action"):
        list(verify_dataset(SMALL))


def test_a_wrong_count_is_found(root):
    path = root / "meta" / "stats.json"
    stats = json.loads(path.read_text())
    stats["action"]["count"][0] += 1
    path.write_text(json.dumps(stats))
    write_manifest(SMALL, root)
    with pytest.raises(ValueError, match="the recorded count of the column action"):
        list(verify_dataset(SMALL))


@pytest.mark.parametrize("fact", ["dataset_from_index", "dataset_to_index"])
def test_a_wrong_place_of_an_episode_is_found(root, fact):
    path = root / "meta" / "episodes" / "chunk-000" / "file-000.parquet"
    episodes = pd.read_parquet(path)
    episodes.loc[1, fact] += 1
    episodes.to_parquet(path)
    write_manifest(SMALL, root)
    with pytest.raises(ValueError, match="first or last frame of an episode"):
        list(verify_dataset(SMALL))


def test_a_task_in_other_words_is_found(root):
    tasks = read_tasks(root)
    index = pd.Index(["Load it as you like.", *tasks[1:]], name="task")
    frame = pd.DataFrame({"task_index": range(len(tasks))}, index=index)
    frame.to_parquet(root / "meta" / "tasks.parquet")
    write_manifest(SMALL, root)
    with pytest.raises(ValueError, match="task of episode 0 is not its preference in words"):
        list(verify_dataset(SMALL))


def test_a_demonstration_that_does_not_load_the_dishwasher_is_found(root):
    """The last decision, which closes the door, becomes one that pulls a rack out again."""
    columns = read_columns(root)
    last = int(np.flatnonzero(columns["next.done"])[0])
    rows = columns["observation.instances"][last]
    other = (columns["chosen_index"][last] + 1) % 3
    spoil(root, "chosen_index", last, other)
    spoil(root, "action", last, rows[other, 3:10])
    write_manifest(SMALL, root)
    with pytest.raises(ValueError, match="episode 0 does not load the dishwasher"):
        list(verify_dataset(SMALL))


@pytest.mark.slow
def test_the_noisy_data_set_is_right(tmp_path, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    make_dataset(NOISY)
    assert list(verify_dataset(NOISY))


def test_the_fingerprint_depends_on_values_and_order_but_not_on_files(root):
    columns, tasks = read_columns(root), read_tasks(root)
    original = fingerprint(columns, tasks)
    rewritten = pq.read_table(data_file(root))
    pq.write_table(rewritten, data_file(root), compression="zstd")
    assert fingerprint(read_columns(root), tasks) == original
    reversed_columns = {name: values[::-1] for name, values in columns.items()}
    assert fingerprint(reversed_columns, tasks) != original
    assert fingerprint(columns, tasks[::-1]) != original


def data_file(root):
    return root / "data" / "chunk-000" / "file-000.parquet"


def spoil(root, column, frame, value):
    """Change one frame of a column, and make the statistics fit, to hide it from other checks."""
    table = pq.read_table(data_file(root))
    values = read_columns(root)[column].copy()
    values[frame] = value
    position = table.schema.get_field_index(column)
    changed = pa.array(values.tolist(), table.schema.field(position).type)
    pq.write_table(table.set_column(position, column, changed), data_file(root))
    stats = json.loads((root / "meta" / "stats.json").read_text())
    lengths = pq.read_table(root / "meta" / "episodes")["length"].to_numpy()
    of_episodes = [
        compute_episode_stats({column: part}, {column: {"dtype": values.dtype.name}})
        for part in np.split(values, np.cumsum(lengths)[:-1])
    ]
    fitting = aggregate_stats(of_episodes)[column]
    stats[column] = {kind: found.tolist() for kind, found in fitting.items()}
    (root / "meta" / "stats.json").write_text(json.dumps(stats))


def test_the_folder_is_lerobots(tmp_path, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    assert dataset_root(SMALL) == tmp_path / "kitchen_prefs" / SMALL

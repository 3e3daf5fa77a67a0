"""A data set on disk is held against its manifest."""

import json

import pytest

from kitchen_prefs.datasets import dataset_names, dataset_root, load_dataset, make_dataset
from kitchen_prefs.datasets.manifest import MANIFEST, published_fingerprint
from kitchen_prefs.datasets.verification import verify_dataset
from kitchen_prefs.splits import DATA_VERSION, SPLITS

SMALL = "dishwasher-train-p2-d2-v1"


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


def test_what_a_failed_edit_in_place_left_behind_is_named_with_the_way_back(home):
    root = make_dataset(SMALL)
    before = root.rename(root.with_name(f"{root.name}_old"))  # as lerobot-edit-dataset does
    with pytest.raises(ValueError, match=f"left it in {before}; move that back, or delete it"):
        load_dataset(SMALL)
    (root / "meta").mkdir(parents=True)
    way_back = f"left what was there in {before}; delete the folder {root} and move {before} back"
    with pytest.raises(ValueError, match=way_back):
        load_dataset(SMALL)
    with pytest.raises(ValueError, match=way_back):
        list(verify_dataset(SMALL))


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


def test_published_names_are_recorded_with_a_fingerprint():
    of_the_first_tier = [name for name in dataset_names() if name.endswith(f"-v{DATA_VERSION}")]
    assert len(of_the_first_tier) == len(SPLITS) + 1
    for name in of_the_first_tier:
        assert len(published_fingerprint(name) or "") == 64
    assert published_fingerprint(SMALL) is None


def test_a_data_set_of_an_earlier_format_is_made_again(home):
    root = make_dataset(SMALL)
    fingerprint = json.loads((root / MANIFEST).read_text())["fingerprint"]
    as_format_1(root)
    with pytest.raises(ValueError, match=rf"is of format 1.*datasets make {SMALL}` makes it again"):
        list(verify_dataset(SMALL))
    with pytest.warns(UserWarning, match="is of an earlier format, so it is made again"):
        dataset = load_dataset(SMALL)
    assert dataset[0]["observation.instances"].shape == (936,)
    manifest = json.loads((root / MANIFEST).read_text())
    assert (manifest["format"], manifest["fingerprint"]) == (2, fingerprint)


def test_a_damaged_data_set_of_an_earlier_format_is_kept(home):
    root = make_dataset(SMALL)
    as_format_1(root)
    (root / "meta" / "stats.json").write_text("{}")
    with pytest.raises(ValueError, match=r"is damaged \(meta/stats\.json .*delete the folder"):
        load_dataset(SMALL)
    assert (root / "meta" / "stats.json").read_text() == "{}"


def as_format_1(root):
    """Make a manifest one of the first format, which did not name itself."""
    manifest = json.loads((root / MANIFEST).read_text())
    manifest.pop("format")
    (root / MANIFEST).write_text(json.dumps(manifest))

"""`kitchen-prefs datasets push`, against a hub on this machine."""

import shutil
import textwrap

import pytest
from hub_server import Commit, Repository, kitchen_prefs, run

from kitchen_prefs.datasets import dataset_root, make_dataset
from kitchen_prefs.datasets.hub_upload import push_dataset

pytestmark = [
    pytest.mark.xdist_group("datasets_hub_upload"),  # one fixture of the module serves all
    pytest.mark.slow,  # most tests start the hub's client in a process of its own
]

SMALL = "dishwasher-train-p1-d1-v1"
REPO_ID = f"ada/{SMALL}"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A small data set, not to be changed."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(tmp_path_factory.mktemp("home")))
        return make_dataset(SMALL)


@pytest.fixture
def root(made, tmp_path, monkeypatch):
    """The same, to be pushed or spoilt."""
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    return shutil.copytree(made, dataset_root(SMALL))


def push(hub, root, *options, **environment):
    command = ("datasets", "push", SMALL, *options)
    return kitchen_prefs(hub, *command, HF_LEROBOT_HOME=str(root.parents[1]), **environment)


def files_in(folder):
    paths = [path for path in folder.rglob("*") if path.is_file()]
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}


@pytest.mark.lerobot
def test_every_file_arrives_and_lerobot_loads_the_data_set(hub, root, tmp_path):
    whole = files_in(root)
    (root / "notes.txt").write_text("mine")  # no part of the data set, so it stays here
    done = push(hub, root, f"--repo-id={REPO_ID}", "--private")
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{SMALL} is at {hub.address}/datasets/{REPO_ID}\n"
    repository = hub.repositories["datasets", REPO_ID]
    assert repository.about["visibility"] == "private"
    assert repository.files == whole
    assert f"# {SMALL}" in repository.files["README.md"].decode()
    assert [commit.message for commit in repository.commits[1:]] == [f"Data set {SMALL}"]
    assert repository.tags == {"v3.0": repository.commits[-1]}
    loaded = load_from(hub, tmp_path / "loaded")
    assert loaded.stdout.split() == ["1", "34"], loaded.stderr
    assert files_in(tmp_path / "loaded").items() >= whole.items()


def load_from(hub, folder):
    """Load the data set by LeRobot, from the hub alone."""
    program = f"""
        from lerobot.datasets import LeRobotDataset

        dataset = LeRobotDataset("{REPO_ID}", root="{folder}")
        print(dataset.num_episodes, len(dataset))
    """
    return run(hub, "-c", textwrap.dedent(program))


@pytest.mark.lerobot
def test_the_tag_of_what_was_there_moves(hub, root):
    older = Commit("Older", "", {"README.md": b"# Older", "LICENSE": b"Apache"})
    repository = Repository({"visibility": "public"}, [older], {"v3.0": older})
    hub.repositories["datasets", REPO_ID] = repository
    done = push(hub, root, f"--repo-id={REPO_ID}")
    assert done.returncode == 0, done.stderr
    assert repository.files == {"LICENSE": b"Apache"} | files_in(root)
    assert repository.tags == {"v3.0": repository.commits[1]}


def spoil_data(root):
    (root / "data" / "chunk-000" / "file-000.parquet").write_bytes(b"spoilt")
    return "is damaged (data/chunk-000/file-000.parquet is not as written)"


def spoil_manifest(root):
    (root / "meta" / "kitchen_prefs.json").unlink()
    return "is incomplete"


def spoil_card(root):
    (root / "README.md").unlink()
    return "lacks its card"


@pytest.mark.parametrize("spoil", [spoil_data, spoil_manifest, spoil_card])
def test_nothing_is_sent_of_a_data_set_that_is_not_whole(hub, root, spoil):
    wrong = spoil(root)
    done = push(hub, root, f"--repo-id={REPO_ID}")
    assert done.returncode == 1
    (sentence,) = done.stderr.splitlines()
    way_out = f"delete the folder {root} and ask for the data set again."
    assert sentence == f"kitchen-prefs: The data set {SMALL} {wrong}; {way_out}"
    assert hub.asked == []


def test_a_client_that_is_to_stay_offline(root, monkeypatch):
    monkeypatch.setattr("huggingface_hub.constants.HF_HUB_OFFLINE", True)
    with pytest.raises(OSError, match="HF_HUB_OFFLINE=1 keeps everything from the hub"):
        push_dataset(SMALL, REPO_ID)


def test_a_name_that_no_repository_can_have(root):
    with pytest.raises(ValueError, match="No repository can be named 'dishes'; give --repo-id="):
        push_dataset(SMALL, "dishes")

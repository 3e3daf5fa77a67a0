"""`kitchen-prefs leaderboard push` and `push-page`, against a hub on this machine."""

import bz2
import hashlib
import json
import textwrap

import pytest
import yaml
from hub_server import Repository, kitchen_prefs, pointer, run
from typer.testing import CliRunner

from kitchen_prefs.splits import TEST_SPLITS, get_split
from kitchen_prefs_leaderboard import commands, hub_upload

pytestmark = pytest.mark.slow  # most tests start the hub's client in a process of its own

BOARD = "bob/leaderboard"
SPACE = "ada/leaderboard"
DESCRIPTION = {
    "format": 1,
    "name": "Nobody",
    "authors": ["A. Author", "B. Author"],
    "track": "standard",
    "policy": {"type": "none"},
    "data_version": 1,
    "fingerprints": {},
    "packages": {},
    "hardware": "none",
    "training": "none",
}


@pytest.fixture
def submission(tmp_path):
    """A folder that reads as a submission; its actions would not replay."""
    folder = tmp_path / "my_ttp"
    folder.mkdir()
    (folder / "submission.json").write_text(json.dumps(DESCRIPTION))
    episode = {"first": "0" * 64, "actions": [[0, 0, 0, 1, 0, 0, 0]], "last": "0" * 64}
    for split in TEST_SPLITS:
        lines = [{"session": i, **episode} for i in range(get_split(split).sessions)]
        text = "\n".join(map(json.dumps, lines))
        (folder / f"{split}.jsonl.bz2").write_bytes(bz2.compress(text.encode()))
    return folder


@pytest.fixture
def board(hub):
    """A leaderboard that is bob's, still empty."""
    repository = Repository({"visibility": "public"})
    hub.repositories["datasets", BOARD] = repository
    return repository


@pytest.fixture
def page(tmp_path):
    file = tmp_path / "leaderboard.html"
    file.write_text("<!doctype html><title>Dishes</title>")
    return file


def push(hub, submission, *options, **environment):
    return kitchen_prefs(hub, "leaderboard", "push", str(submission), *options, **environment)


def push_page(hub, page, repo_id=SPACE, **environment):
    command = ("leaderboard", "push-page", str(page), f"--repo-id={repo_id}")
    return kitchen_prefs(hub, *command, **environment)


def refusal(done):
    """The one sentence that a command which failed says."""
    assert done.returncode == 1
    assert done.stdout == ""
    (sentence,) = done.stderr.splitlines()
    return sentence.removeprefix("kitchen-prefs: ")


def files_in(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_a_submission_becomes_one_pull_request_of_its_seven_files(hub, board, submission):
    whole = files_in(submission)
    (submission / "notes.txt").write_text("mine")  # no part of it, so it stays here
    done = push(hub, submission, f"--repo-id={BOARD}")
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"The pull request is {hub.address}/datasets/{BOARD}/discussions/1.\n"
    (proposed,) = board.pull_requests
    assert proposed.files == {f"my_ttp/{name}": content for name, content in whole.items()}
    assert len(proposed.files) == 7
    assert proposed.message == "Submission my_ttp"
    assert proposed.description == "Nobody, standard track, by A. Author, B. Author"
    assert board.files == {}


def test_a_submission_goes_through_xet_as_the_client_has_it(hub, board, submission, tmp_path):
    """Its default: the large files go into a store of their own, their hashes into the commit."""
    done = push(hub, submission, f"--repo-id={BOARD}", "--name=other", HF_HUB_DISABLE_XET="0")
    assert done.returncode == 0, done.stderr
    (proposed,) = board.pull_requests
    for name, content in files_in(submission).items():
        large = pointer(hashlib.sha256(content).hexdigest())
        assert proposed.files[f"other/{name}"] == (large if name.endswith(".bz2") else content)
    assert hub.large == {}
    assert stored_by_xet(hub, submission / "seen.jsonl.bz2", tmp_path / "stored")


def stored_by_xet(hub, file, copy):
    """Whether the store gives back a file's bytes."""
    program = f"""
        import hf_xet

        (hashed,) = hf_xet.hash_files(["{file}"])
        wanted = hf_xet.PyXetDownloadInfo("{copy}", hashed.hash, hashed.file_size)
        hf_xet.download_files([wanted], "{hub.xet_store}", None, None, None)
    """
    done = run(hub, "-c", textwrap.dedent(program))
    assert done.returncode == 0, done.stderr
    return copy.read_bytes() == file.read_bytes()


def test_a_submission_that_is_there_already_is_not_proposed_again(hub, board, submission):
    push(hub, submission, f"--repo-id={BOARD}")
    board.commits += board.pull_requests  # bob takes it
    done = push(hub, submission, f"--repo-id={BOARD}")
    assert done.returncode == 1
    said = f"kitchen-prefs: {BOARD} has this submission already, in its folder my_ttp."
    assert done.stderr.splitlines()[-1] == said
    assert len(board.pull_requests) == 1


@pytest.mark.parametrize(
    ("file", "content", "said"),
    [
        ("submission.json", b"{}", "submission.json does not follow the format"),
        (
            "seen.jsonl.bz2",
            bz2.compress(b"{}"),
            "seen.jsonl.bz2, line 1 does not follow the format",
        ),
        ("noisy.jsonl.bz2", b"", "noisy.jsonl.bz2 is not one whole bzip2 file"),
    ],
)
def test_nothing_is_sent_of_what_is_no_submission(hub, board, submission, file, content, said):
    (submission / file).write_bytes(content)
    assert said in refusal(push(hub, submission, f"--repo-id={BOARD}"))
    assert hub.asked == []


@pytest.mark.parametrize("name", ["../other", ".hidden", "a/b", "a b"])
def test_a_name_that_is_no_folder(submission, name):
    with pytest.raises(ValueError, match="is no name for a folder on the hub; give a --name of"):
        hub_upload.push_submission(submission, BOARD, name)


def test_a_leaderboard_that_is_not_there(hub, submission):
    said = refusal(push(hub, submission, "--repo-id=bob/nothing"))
    assert said == "The hub has no bob/nothing, or you may not see it; give another --repo-id."


def test_a_submission_of_someone_unknown(hub, board, submission):
    said = refusal(push(hub, submission, f"--repo-id={BOARD}", HF_TOKEN=""))
    assert said == (
        f"The hub does not know you, or knows no {BOARD}; log in with `hf auth login`, or put "
        "a token of yours into HF_TOKEN."
    )
    assert board.pull_requests == []


def test_the_page_becomes_a_static_space(hub, page):
    for content in ("<!doctype html>old", "<!doctype html>new"):
        page.write_text(content)
        done = push_page(hub, page)
        assert done.returncode == 0, done.stderr
        assert done.stdout == f"The page is shown at {hub.address}/spaces/{SPACE}.\n"
    repository = hub.repositories["spaces", SPACE]
    assert repository.about["sdk"] == "static"
    assert repository.files.keys() == {"index.html", "README.md"}
    assert repository.files["index.html"] == page.read_bytes()
    header = yaml.safe_load(repository.files["README.md"].decode().split("---\n")[1])
    assert header["sdk"] == "static"
    assert header["app_file"] == "index.html"
    assert header["title"] == "kitchen_prefs leaderboard"


def test_a_page_that_is_not_there(hub, tmp_path):
    said = refusal(push_page(hub, tmp_path / "no.html"))
    assert said.endswith("no.html; `kitchen-prefs leaderboard page` writes one.")
    assert hub.asked == []


@pytest.mark.parametrize("repo_id", ["leaderboard", "a/b/c", "ada/--", "ada/b c", ""])
def test_a_name_that_no_repository_can_have(submission, page, repo_id):
    for push_it in (
        lambda: hub_upload.push_page(page, repo_id),
        lambda: hub_upload.push_submission(submission, repo_id, "my_ttp"),
    ):
        with pytest.raises(ValueError, match="No repository can be named") as error:
            push_it()
        assert str(error.value).endswith(f"{repo_id!r}; give --repo-id=OWNER/NAME.")


def test_a_token_that_the_hub_does_not_know(hub, page):
    said = refusal(push_page(hub, page, HF_TOKEN="hf_of_nobody"))
    assert said.startswith(f"The hub does not know you, or knows no {SPACE}; log in with")
    assert "hf_of_nobody" not in said
    assert hub.repositories == {}


def test_a_space_of_someone_else(hub, page):
    said = refusal(push_page(hub, page, "bob/leaderboard"))
    assert said.startswith("Your token may not write to bob/leaderboard; use one that may, or")
    assert hub.repositories == {}


def test_a_hub_that_is_out_of_order(hub, page):
    hub.out_of_order = {"POST": 418}
    said = refusal(push_page(hub, page))
    assert said == f"The hub refuses what goes to {SPACE} (418: Out of order.); try again later."


def test_an_upload_that_breaks_off(hub, board, submission):
    hub.out_of_order = {"PUT": 418}
    said = refusal(push(hub, submission, f"--repo-id={BOARD}"))
    assert said == f"An upload to {BOARD} broke off; push again."
    assert board.pull_requests == []


def test_a_hub_that_does_not_answer(hub, page, submission):
    nowhere = "http://127.0.0.1:9"
    for done in (
        push_page(hub, page, HF_ENDPOINT=nowhere),
        push(hub, submission, f"--repo-id={BOARD}", HF_ENDPOINT=nowhere),
    ):
        assert refusal(done) == (
            f"No hub answers at {nowhere}; look after the network and the environment variable "
            "HF_ENDPOINT, and push again."
        )


def test_a_client_that_is_to_stay_offline(hub, page):
    said = refusal(push_page(hub, page, HF_HUB_OFFLINE="1"))
    assert said == "HF_HUB_OFFLINE=1 keeps everything from the hub; unset it."
    assert hub.asked == []


@pytest.mark.parametrize("command", ["push", "push-page"])
def test_each_command_has_an_example(command):
    help_text = CliRunner().invoke(commands.app, [command, "--help"]).output
    assert f"kitchen-prefs leaderboard {command} outputs/" in help_text

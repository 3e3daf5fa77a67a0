"""Plug-ins: what a submission says of a policy's code, and what a re-run says where it differs."""

import json
import sys
from pathlib import Path

import pytest

from kitchen_prefs_leaderboard.page.building import page_data
from kitchen_prefs_leaderboard.plugin_identity import find_plugin
from kitchen_prefs_leaderboard.ranking import rank
from kitchen_prefs_leaderboard.submission_format import Plugin, Policy
from kitchen_prefs_leaderboard.submission_reading import read_submission
from kitchen_prefs_leaderboard.submission_writing import write_submission
from kitchen_prefs_leaderboard.verification import check_policy

ATTACKERS = Path(__file__).parents[1] / "attackers"
PACKAGE = "lerobot_policy_elsewhere"
PLUGIN = Plugin(distribution=PACKAGE, version="1.2", code="c" * 64)


@pytest.fixture
def install(tmp_path):
    """Installs a plug-in, its code beside its metadata or elsewhere as an editable one."""

    def to(name, code, version="1.2"):
        metadata = tmp_path / name / f"{PACKAGE}-{version}.dist-info/METADATA"
        metadata.parent.mkdir(parents=True)
        metadata.write_text(f"Metadata-Version: 2.1\nName: {PACKAGE}\nVersion: {version}\n")
        return add_code(code or tmp_path / name)

    def add_code(folder):
        for file in ("__init__.py", "inner/model.py", "__pycache__/model.cpython-312.pyc"):
            path = folder / PACKAGE / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(f"assert False, {str(folder) if 'pycache' in file else file!r}")
        return folder

    return to


def test_a_plugin_is_known_without_importing_it():
    found = find_plugin("lerobot_policy_attackers", ATTACKERS)
    assert (found.distribution, found.version) == ("lerobot_policy_attackers", "1")
    assert "lerobot_policy_attackers" not in sys.modules


def test_an_editable_plugin_is_the_same_as_an_installed_one(install, tmp_path, monkeypatch):
    installed = find_plugin(PACKAGE, install("installed", None))
    monkeypatch.syspath_prepend(install("metadata", tmp_path / "checkout"))
    monkeypatch.syspath_prepend(tmp_path / "metadata")
    assert find_plugin(PACKAGE) == installed


def test_the_plugin_of_the_folder_comes_before_one_that_is_installed(
    install, tmp_path, monkeypatch
):
    monkeypatch.syspath_prepend(install("here", None, version="1"))
    assert find_plugin(PACKAGE, install("there", None, version="2")).version == "2"


@pytest.mark.parametrize("change", ["bytes", "name", "more"])
def test_other_code_is_another_plugin(install, change):
    folder = install("installed", None)
    before, file = find_plugin(PACKAGE, folder), folder / PACKAGE / "inner/model.py"
    if change == "bytes":
        file.write_text(file.read_text() + " ")
    if change == "name":
        file.rename(file.with_name("other.py"))
    if change == "more":
        file.with_name("more.py").touch()
    after = find_plugin(PACKAGE, folder)
    assert after.code != before.code
    assert after == before.model_copy(update={"code": after.code})


@pytest.mark.parametrize("package", ["lerobot_policy_nowhere", "../attackers", "numpy.linalg", ""])
def test_a_plugin_that_is_not_there_is_one_sentence(package):
    with pytest.raises(ValueError, match=r"^The policy's package '.*' is not installed"):
        find_plugin(package, ATTACKERS)


@pytest.mark.parametrize(
    ("installed", "named"),
    [
        (
            PLUGIN.model_copy(update={"version": "1.3"}),
            rf"this one from {PACKAGE} 1\.3 \(code cccc",
        ),
        (PLUGIN.model_copy(update={"code": "d" * 64}), rf"{PACKAGE} 1\.2 \(code dddddddddddd\)"),
        (None, "this one from LeRobot or this benchmark; install the submission's"),
    ],
)
def test_what_differs_from_the_submission_is_said(make_entry, installed, named):
    policy = Policy(type="elsewhere", checkpoint="e" * 64, plugin=PLUGIN)
    submission = make_entry("a", policy=policy).submission
    check_policy(submission, policy)
    with pytest.raises(ValueError, match=rf"comes from {PACKAGE} 1\.2 \(code cccc.*{named}"):
        check_policy(submission, policy.model_copy(update={"plugin": installed}))


@pytest.mark.usefixtures("few_sessions")
def test_a_submission_and_its_row_name_the_plugin_where_there_is_one(
    make_entry, few_episodes, tmp_path
):
    of_ours, of_elsewhere = (
        make_entry(name, policy=Policy(type=name, checkpoint=name * 64, plugin=plugin))
        for name, plugin in (("a", None), ("b", PLUGIN))
    )
    for entry, named in ((of_ours, False), (of_elsewhere, True)):
        folder = tmp_path / entry.submission.name
        write_submission(entry.submission, few_episodes(), folder)
        assert ("plugin" in json.loads((folder / "submission.json").read_text())["policy"]) == named
        assert read_submission(folder).description == entry.submission
    rows = page_data({"preferences": rank([of_ours, of_elsewhere], {})})["entries"]
    assert [row["submission"]["policy"]["plugin"] for row in rows] == [None, PLUGIN.model_dump()]

"""Demonstrations as a data set: labels, consent, prompts of evaluations."""

import json

import numpy as np
import pytest
from lerobot.datasets import LeRobotDataset
from simulated_users import NUMBERS, content_of, slipping

from kitchen_prefs.datasets.manifest import read_manifest
from kitchen_prefs.datasets.prompt_reading import read_prompt
from kitchen_prefs.evaluation.evaluator import Evaluator
from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.preferences import preference_from_number
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs_demonstrations.importing import MADE_OF, import_demonstrations
from kitchen_prefs_demonstrations.kitchens import page_sessions
from kitchen_prefs_demonstrations.replaying import read_and_replay

pytestmark = [pytest.mark.lerobot, pytest.mark.xdist_group("imported_demonstrations")]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Two demonstrations by experts, two of a user who slips, and an unfinished one."""
    folder = tmp_path_factory.mktemp("files")
    sessions = page_sessions(4)
    preferences = [preference_from_number(number) for number in NUMBERS]
    slips = [
        content_of(session, preferences[2], decisions=slipping(session, preferences[2], 0.5, 0))
        for session in sessions[2:]
    ]
    contents = [
        *(content_of(sessions[i], preferences[i], user=f"user {i}") for i in (0, 1)),
        *slips,
        content_of(sessions[0], preferences[0], user=None),
    ]
    contents[4]["decisions"] = contents[4]["decisions"][:4]
    for number, content in enumerate(contents):
        (folder / f"{number}.json").write_text(json.dumps(content))
    return sorted(folder.iterdir())


@pytest.fixture(scope="module")
def home(tmp_path_factory, files):
    """A home with the data set `mine`."""
    folder = tmp_path_factory.mktemp("home")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(folder))
        import_demonstrations(files, "mine")
    return folder


@pytest.fixture(autouse=True)
def _at_home(home, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(home))


@pytest.fixture
def root(home):
    return home / "kitchen_prefs" / "mine"


def test_it_is_a_data_set_of_lerobot_and_of_the_project(root, files):
    assert read_manifest("mine", root)["episodes"] == len(files)
    dataset = LeRobotDataset("kitchen_prefs/mine", root=root)
    lengths = [len(read_and_replay(file).decisions) for file in files]
    episodes = np.array(dataset.hf_dataset["episode_index"])
    assert np.bincount(episodes).tolist() == lengths


def test_labels_say_who_follows_what(root):
    made_of = json.loads((root / MADE_OF).read_text())["episodes"]
    labels = [episode["preference"] for episode in made_of]
    assert labels[:2] == [12 + NUMBERS[0], 12 + NUMBERS[1]]
    assert labels[2] == labels[3] < 0  # one user
    assert labels[4] < 0
    assert labels[4] != labels[3]
    assert [episode["user"] for episode in made_of] == ["user 0", "user 1", "Ada", "Ada", None]
    assert [episode["finished"] for episode in made_of] == [True] * 4 + [False]
    assert all(episode["consent"] for episode in made_of)


def test_an_episode_prompts_as_its_file_does(files):
    given = read_prompt("mine:1")
    assert np.array_equal(given.rows, read_and_replay(files[1]).prompt)
    assert given.preference == preference_from_number(NUMBERS[1])


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("mine:2", "follows no preference of the benchmark, so no expert says"),
        ("mine:5", "has no episode 5; the last is 4"),
        ("mine:-1", "NAME or NAME:EPISODE"),
        ("yours", "There is no data set yours in"),
    ],
)
def test_what_cannot_prompt_is_refused(name, sentence):
    with pytest.raises(ValueError, match=sentence):
        read_prompt(name)


def test_a_policy_is_evaluated_for_the_user_of_the_prompt(tmp_path, few_sessions):
    given = read_prompt("mine:0")
    rule = load_policy(policy_type="rules", options=["--rule=symbolic"])
    evaluator = Evaluator(rule, tmp_path, given=given)
    summary = evaluator.evaluate("seen")
    assert summary.metrics["PE"].mean == 1
    assert "Rescaled" not in summary.metrics
    assert {episode.preference for episode in evaluator.episodes("seen")} == {12 + NUMBERS[0]}
    with pytest.raises(ValueError, match="another given_prompt"):
        Evaluator(rule, tmp_path, given=read_prompt("mine:1")).evaluate("seen")


def test_a_session_of_the_same_preference_is_the_published_one():
    published = make_session("seen", 3)
    assert np.array_equal(
        make_session("seen", 3, 0, published.preference).dishes.pose, published.dishes.pose
    )


def test_consent_is_asked_for(files, tmp_path):
    file = tmp_path / "silent.json"
    file.write_text(json.dumps(json.loads(files[0].read_text()) | {"consent": False}))
    with pytest.raises(ValueError, match=r"silent\.json came without consent"):
        import_demonstrations([files[0], file], "silent")
    assert len(import_demonstrations([file], "silent", without_consent=True)) == 1


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("mine", "holds something already"),
        ("dishwasher-train-v1", "name of a published data set"),
        ("dishwasher-people_val-v2", "name of a published data set"),
        ("../mine", "small letters"),
        ("Mine", "small letters"),
    ],
)
def test_a_name_that_cannot_be_is_refused(files, home, name, sentence):
    before = sorted(home.rglob("*"))
    with pytest.raises(ValueError, match=sentence):
        import_demonstrations(files[:1], name)
    assert sorted(home.rglob("*")) == before


def test_a_bad_file_leaves_nothing(files, tmp_path, home):
    (tmp_path / "bad.json").write_text("{}")
    with pytest.raises(ValueError, match=r"bad\.json does not follow"):
        import_demonstrations([*files, tmp_path / "bad.json"], "bad")
    assert not list((home / "kitchen_prefs").glob("*bad*"))

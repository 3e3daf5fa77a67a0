"""The commands `submit` and `verify` roll a policy out; the test splits are cut short."""

import bz2
import json
from dataclasses import replace
from pathlib import Path

import pytest
import warm_python
from short_splits import short_splits

from kitchen_prefs.cli import command_line
from kitchen_prefs.datasets.manifest import published_fingerprint
from kitchen_prefs.evaluation.episode_files import read_episodes
from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.splits import TEST_SPLITS
from kitchen_prefs_leaderboard import policy_runs
from kitchen_prefs_leaderboard.scoring import score_submissions
from kitchen_prefs_leaderboard.submission_format import ACTIONS, installed_packages
from kitchen_prefs_leaderboard.submission_writing import policy_of, training_of
from kitchen_prefs_leaderboard.verification import read_verifications

CHECKPOINT = Path(__file__).parents[2] / "policies" / "checkpoints" / "ttp_quick"
SYMBOLIC = ("--policy.type=rules", "--policy.rule=symbolic")
SUBMIT = (
    *("leaderboard", "submit", "--name=Symbolic", "--track=standard", "--training=none"),
    *("--author=A. Author", "--author=B. Author", *SYMBOLIC),
)

pytestmark = [pytest.mark.xdist_group("submitted"), pytest.mark.usefixtures("few_sessions")]


@pytest.fixture(scope="session")
def submitted(made_once):
    """What the program itself submits, and beside it the episodes that it rolled out."""

    def fill(folder):
        out = f"--out={folder / 'symbolic'}"
        with short_splits():
            done = warm_python.run("-m", "kitchen_prefs.cli", *SUBMIT, out, "--jobs=2")
        assert done.returncode == 0, done.stderr
        assert "Rolling out, many_preferences: 100%" in done.stderr

    return made_once("submitted", fill) / "symbolic"


@pytest.fixture(scope="session")
def entry(submitted):
    """That submission, replayed."""
    with short_splits():
        return score_submissions([submitted], 2)[0]


@pytest.fixture
def here(monkeypatch):
    """Lets splits be rolled out in this process, as another would have to load LeRobot."""

    def run_module(module, arguments, log, name):
        assert module == "kitchen_prefs.cli"
        command_line()(arguments, standalone_mode=False)

    monkeypatch.setattr(policy_runs, "run_module", run_module)


def contents(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir()}


def episodes_of(submitted):
    return submitted.with_name(f"{submitted.name}-episodes")


@pytest.mark.lerobot
@pytest.mark.slow
def test_a_submission_says_who_acted_and_holds_no_score(submitted):
    assert contents(submitted).keys() == {"submission.json", *map(ACTIONS.get, TEST_SPLITS)}
    about = json.loads((submitted / "submission.json").read_text())
    assert about.pop("hardware")
    assert about == {
        "format": 1,
        "name": "Symbolic",
        "authors": ["A. Author", "B. Author"],
        "link": None,
        "track": "standard",
        "policy": {
            "type": "rules",
            "parameters": 0,
            "checkpoint": load_policy(policy_type="rules").fingerprint,
        },
        "data_version": 1,
        "fingerprints": {
            name: published_fingerprint(name)
            for name in (f"dishwasher-{split}-v1" for split in TEST_SPLITS)
        },
        "packages": installed_packages(),
        "training": "none",
    }


@pytest.mark.lerobot
@pytest.mark.slow
def test_its_actions_lead_where_they_led_when_they_were_played(submitted, entry):
    folder = episodes_of(submitted)
    for split, episodes in entry.episodes.items():
        rolled_out = sorted(read_episodes(folder / f"{split}.jsonl"), key=lambda one: one.session)
        assert episodes == [
            replace(one, actions=again.actions)
            for one, again in zip(rolled_out, episodes, strict=True)
        ]
        said = json.loads((folder / f"{split}.json").read_text())["metrics"]
        assert {name: vars(interval) for name, interval in entry.metrics[split].items()} == said


@pytest.mark.lerobot
@pytest.mark.slow
def test_its_actions_are_rounded(submitted):
    for file in map(ACTIONS.get, TEST_SPLITS):
        for line in bz2.decompress((submitted / file).read_bytes()).splitlines():
            numbers = [number for action in json.loads(line)["actions"] for number in action]
            assert numbers == [round(number, 4) for number in numbers]


@pytest.mark.lerobot
@pytest.mark.slow
def test_submitting_again_plays_what_is_missing_and_gives_the_same_bytes(
    submitted, here, kitchen_prefs, tmp_path
):
    out = tmp_path / "again"
    rolled_out = contents(episodes_of(submitted))
    episodes_of(out).mkdir()
    for name, content in rolled_out.items():
        (episodes_of(out) / name).write_bytes(content)
    cut = episodes_of(out) / "seen.jsonl"
    cut.write_bytes(cut.read_bytes()[:-100])
    for _ in range(2):  # the second one replaces what the first one wrote
        assert kitchen_prefs(*SUBMIT, f"--out={out}", "--jobs=1") == 0
        assert contents(out) == contents(submitted)
        assert contents(episodes_of(out)) == rolled_out


@pytest.mark.parametrize(
    ("wrong", "sentence"),
    [
        (
            "--track=secret",
            "There is no track 'secret'. There are: standard, privileged, language, open.",
        ),
        (f"--name={'x' * 61}", "This cannot be submitted: name: String should have at most 60"),
        ("--link=javascript:alert(1)", "This cannot be submitted: link: "),
        ("--policy.rule=expert", "The rule 'expert' needs 'observation.preference'"),
        ("--policy.path=nowhere", "Give either --policy.path=CHECKPOINT or --policy.type=TYPE."),
        ("--policy.colour=red", "colour"),
        ("--colour=red", "There is no option '--colour=red'"),
    ],
)
def test_a_mistake_is_said_before_anything_is_played(
    wrong, sentence, here, kitchen_prefs, tmp_path
):
    said = kitchen_prefs(*SUBMIT, f"--out={tmp_path / 'out'}", wrong)
    assert sentence in said
    assert said.startswith("kitchen-prefs: ")
    assert "\n" not in said
    assert list(tmp_path.iterdir()) == []


def test_another_folder_is_not_replaced(kitchen_prefs, tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "submission.json").write_text("{}")
    said = kitchen_prefs(*SUBMIT, f"--out={tmp_path}")
    assert "is something else than a submission; give another --out." in said
    assert (tmp_path / "notes.txt").read_text() == "mine"
    assert not episodes_of(tmp_path).exists()


def test_a_link_is_not_replaced(kitchen_prefs, tmp_path):
    (tmp_path / "folder").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "folder")
    said = kitchen_prefs(*SUBMIT, f"--out={tmp_path / 'link'}")
    assert "is something else than a submission; give another --out." in said


@pytest.mark.lerobot
@pytest.mark.slow
def test_episodes_of_another_policy_are_not_submitted(submitted, here, kitchen_prefs, tmp_path):
    header = (episodes_of(submitted) / "seen.header.json").read_text()
    kept = episodes_of(tmp_path / "out")
    kept.mkdir()
    fingerprint = json.loads(header)["fingerprint"]
    (kept / "seen.header.json").write_text(header.replace(fingerprint, "0" * 64))
    said = kitchen_prefs(*SUBMIT, f"--out={tmp_path / 'out'}")
    assert "out-episodes holds episodes of another policy; delete that folder" in said
    assert list(kept.iterdir()) == [kept / "seen.header.json"]


def test_a_checkpoint_is_named_by_what_it_learned_and_how():
    loaded_policy = load_policy(str(CHECKPOINT))
    said = policy_of(loaded_policy)
    assert said.type == "ttp"
    assert (
        said.parameters == sum(weight.numel() for weight in loaded_policy.policy.parameters()) > 0
    )
    assert said.checkpoint == loaded_policy.fingerprint
    config = json.loads((CHECKPOINT / "train_config.json").read_text())
    assert training_of(str(CHECKPOINT)) == (
        f"{config['steps']} steps of 32 decisions of kitchen_prefs/dishwasher-train-v1"
    )


@pytest.mark.lerobot
@pytest.mark.slow
def test_a_rerun_by_the_same_policy_confirms_and_another_is_refused(
    submitted, entry, here, kitchen_prefs, tmp_path, capsys
):
    records = tmp_path / "records"
    arguments = (
        *("leaderboard", "verify", submitted, "--rerun", "--salt=7", "--jobs=1"),
        *(f"--verifications={records}", f"--out={tmp_path / 'out'}", "--policy.type=rules"),
    )
    assert kitchen_prefs(*arguments, "--policy.rule=symbolic") == 0
    shown = capsys.readouterr().out
    for words in (
        "confirms the submission; 100% of the",
        "replayed",
        "run again",
        "fresh sessions",
    ):
        assert words in shown
    (record,) = read_verifications(records).values()
    assert (record.digest, record.salt, record.same) == (entry.digest, 7, 1)
    assert record.rerun == record.replayed
    assert record.replayed.mean == round(entry.metrics["mean"]["Score"].mean, 4)
    assert 0 < record.fresh.mean != record.replayed.mean
    said = kitchen_prefs(*arguments, "--policy.rule=majority")
    assert said.startswith(
        "kitchen-prefs: The submission is of another policy (rules, 0 parameters, "
    )
    assert list(read_verifications(records).values()) == [record]


@pytest.mark.parametrize("jobs", [1, 2, 3, 6, 64])
def test_processes_share_the_splits(jobs):
    shares = policy_runs.shares(TEST_SPLITS, jobs)
    assert sorted(split for share in shares for split in share) == sorted(TEST_SPLITS)
    assert all(shares)
    assert len(shares) <= jobs


@pytest.mark.lerobot
@pytest.mark.slow
def test_only_a_rerun_shows_who_chose_the_actions(submitted, kitchen_prefs, capsys):
    assert kitchen_prefs("leaderboard", "verify", submitted) == 0
    assert "Only a re-run shows which policy chose them" in " ".join(
        capsys.readouterr().out.split()
    )
    said = kitchen_prefs("leaderboard", "verify", submitted, "--policy.path=anything")
    assert said == "kitchen-prefs: A policy is rolled out again with --rerun only; add it."

"""Submissions on the second tier, and on both: written, scored, tampered with, ranked, verified."""

import bz2
import csv
import io
import json
from dataclasses import replace
from pathlib import Path
from shutil import copytree

import pytest
from act_checkpoints import save_act
from short_splits import short_splits

from kitchen_prefs.evaluation.tiers import PEOPLE, PREFERENCES, TIERS
from kitchen_prefs.metrics.people_intervals import summarise_people
from kitchen_prefs_leaderboard.page.building import page_data
from kitchen_prefs_leaderboard.ranking import Row, lead, rank_tiers
from kitchen_prefs_leaderboard.score_formats import to_csv, to_json
from kitchen_prefs_leaderboard.scoring import Entry, read_known, score_submissions
from kitchen_prefs_leaderboard.submission_format import Policy
from kitchen_prefs_leaderboard.submission_writing import describe, write_submission
from kitchen_prefs_leaderboard.verification import read_verifications

SPLITS = [split for tier in TIERS.values() for split in tier.test_splits]
UNSEEN = "people_unseen.jsonl.bz2"
SESSIONS = 2

pytestmark = pytest.mark.xdist_group("people_submissions")  # one fixture of the module serves all


@pytest.fixture(scope="module", autouse=True)
def few_sessions():
    """Cuts the test splits of both tiers down to two sessions."""
    with short_splits(SESSIONS):
        yield


def loaded_by_the_expert(tier, split, session, careless=False):
    """The expert's episode of a session; a careless one sinks the first dish."""
    simulator = tier.make_simulator(split, session)
    while not (simulator.terminated or simulator.truncated):
        action = simulator.expert_action()
        if careless and simulator.kitchen.held is not None:
            action, careless = (
                simulator.observation.rows[simulator.observation.ids == 999][0],
                False,
            )
            action = action[3:10]
        simulator.act(action)
    return simulator.episode()


def about(*tiers, **changes):
    usual = {
        "name": "The expert",
        "authors": ["A. Author"],
        "track": "open",
        "policy": Policy(type="expert", checkpoint="e" * 64),
        "hardware": "none",
        "training": "none",
    }
    return describe(tiers, **(usual | changes))


@pytest.fixture(scope="module")
def episodes():
    """The expert's episodes on the test splits of both tiers."""
    return {
        split: [loaded_by_the_expert(tier, split, i) for i in range(SESSIONS)]
        for tier in TIERS.values()
        for split in tier.test_splits
    }


@pytest.fixture(scope="module")
def folder(episodes, tmp_path_factory):
    """The submission of these episodes; it must stay as it is."""
    folder = tmp_path_factory.mktemp("both") / "submission"
    write_submission(about(PREFERENCES, PEOPLE), episodes, folder)
    return folder


@pytest.fixture(scope="module")
def entries(folder):
    """That submission, scored."""
    return score_submissions([folder], 1)


@pytest.fixture
def copy(folder, tmp_path):
    """A copy of the submission, to be tampered with."""
    return copytree(folder, tmp_path / "copy")


def rewrite(file, change):
    content = json.loads(file.read_text())
    change(content)
    file.write_text(json.dumps(content))


def of_tier(episodes, tier):
    return {split: episodes[split] for split in tier.test_splits}


def test_a_submission_of_both_tiers_says_so_and_holds_no_score(folder):
    content = json.loads((folder / "submission.json").read_text())
    assert content["format"] == 2
    assert content["data_versions"] == {"preferences": 1, "people": 2}
    assert "data_version" not in content
    assert {file.name for file in folder.iterdir()} == {
        "submission.json",
        *(f"{split}.jsonl.bz2" for split in SPLITS),
    }
    for line in bz2.decompress((folder / UNSEEN).read_bytes()).splitlines():
        assert json.loads(line).keys() == {"session", "first", "actions", "last"}


def test_every_figure_is_recomputed_from_the_actions_alone(entries, episodes):
    first, second = entries
    assert (first.tier, second.tier) == (PREFERENCES, PEOPLE)
    for split, replayed in second.episodes.items():
        assert [replace(e, actions=()) for e in replayed] == [
            replace(e, actions=()) for e in episodes[split]
        ]
        assert second.metrics[split] == summarise_people(replayed)
    means = second.metrics["mean"]
    assert (means["Where"].mean, means["Care"].mean, means["Refused"].mean) == (1, 0, 0)
    rescaled = [second.metrics[split]["Rescaled"].mean for split in PEOPLE.test_splits]
    assert means["Rescaled"].mean == pytest.approx(sum(rescaled) / len(rescaled))


def test_a_tier_has_rows_of_its_own_in_json_and_csv(entries):
    first, second = json.loads(to_json(entries, None))
    assert (first["data_version"], second["data_version"]) == (1, 2)
    assert first["name"] == second["name"]
    assert first["digest"] != second["digest"]
    assert list(second["splits"]) == [*PEOPLE.test_splits, "mean"]
    rows = list(csv.DictReader(io.StringIO(to_csv(entries, None))))
    assert {row["metric"] for row in rows if row["split"] == "people_unseen"} >= {"H", "Care"}


def test_the_command_prints_a_table_a_tier_with_floor_and_ceiling(folder, kitchen_prefs, capsys):
    assert kitchen_prefs("leaderboard", "score", folder, "--jobs=1") == 0
    shown = capsys.readouterr().out
    for words in ("Score of floor and ceiling", "H of floor and ceiling", "people_bayes", "Care"):
        assert words in shown
    said = kitchen_prefs("leaderboard", "score", folder, "--jobs=1", "--by=count")
    assert "Entries of the tier 'people' have no groups by count; leave out --by." in said


@pytest.mark.parametrize("tier", TIERS.values(), ids=TIERS)
def test_one_tier_is_enough(episodes, tier, tmp_path):
    write_submission(about(tier), of_tier(episodes, tier), tmp_path / "one")
    (entry,) = score_submissions([tmp_path / "one"], 1)
    assert entry.tier is tier
    (tmp_path / "one" / f"{tier.test_splits[0]}.jsonl.bz2").unlink()
    with pytest.raises(ValueError, match=f"{tier.test_splits[0]}.jsonl.bz2 cannot be read"):
        read_known(tmp_path / "one")


@pytest.mark.parametrize(("tier", "same"), [(PREFERENCES, True), (PEOPLE, False)])
def test_a_digest_is_of_one_tiers_files(folder, copy, tier, same):
    lines = bz2.decompress((copy / UNSEEN).read_bytes())
    (copy / UNSEEN).write_bytes(bz2.compress(lines, 1))
    assert (read_known(copy).digest(tier) == read_known(folder).digest(tier)) == same


@pytest.mark.parametrize("position", [3, 10])
def test_an_action_that_was_changed_is_found(copy, position):
    first, *rest = bz2.decompress((copy / UNSEEN).read_bytes()).splitlines()
    line = json.loads(first)
    line["actions"][position] = line["actions"][position - 1]
    changed = b"\n".join([json.dumps(line).encode(), *rest, b""])
    (copy / UNSEEN).write_bytes(bz2.compress(changed))
    with pytest.raises(ValueError, match=f"{UNSEEN}, line 1: the (actions|episode)"):
        score_submissions([copy], 1)


def test_actions_of_another_session_are_found(copy):
    lines = [json.loads(one) for one in bz2.decompress((copy / UNSEEN).read_bytes()).splitlines()]
    lines[0] = lines[1] | {"session": 0}
    text = "".join(f"{json.dumps(line)}\n" for line in lines)
    (copy / UNSEEN).write_bytes(bz2.compress(text.encode()))
    with pytest.raises(ValueError, match="line 1: session 0 of people_unseen begins in another"):
        score_submissions([copy], 1)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"H": 1.0}, "H: Extra inputs are not permitted"),
        ({"data_versions": {"people": 3}}, "is of data version 3; this version of .* version 2"),
        ({"data_versions": {"robots": 2}}, r"data_versions\.robots"),
        ({"data_versions": {}}, "data_versions: "),
        ({"format": 1}, "Format 1 has a data_version, format 2 has data_versions"),
        ({"data_version": 1}, "Format 1 has a data_version, format 2 has data_versions"),
    ],
)
def test_a_description_that_is_none_is_refused(copy, change, sentence):
    rewrite(copy / "submission.json", lambda content: content.update(change))
    with pytest.raises(ValueError, match=sentence) as error:
        read_known(copy)
    assert "\n" not in str(error.value)


@pytest.fixture(scope="module")
def careless(entries):
    """An entry of the second tier whose first dish is in the sink, in every session."""
    worse = {
        split: [loaded_by_the_expert(PEOPLE, split, i, careless=True) for i in range(SESSIONS)]
        for split in PEOPLE.test_splits
    }
    submission = entries[1].submission.model_copy(update={"name": "Careless"})
    return Entry(submission, "c" * 64, worse)


def test_tiers_are_tables_of_their_own_by_the_mean_of_rescaled_h(entries, careless):
    tables = rank_tiers([careless, *entries], {})
    assert {name: list(tracks) for name, tracks in tables.items()} == {
        "preferences": ["open"],
        "people": ["open"],
    }
    rows = tables["people"]["open"]
    assert [row.entry.submission.name for row in rows] == ["The expert", "Careless"]
    gain = lead(*rows)
    means = [row.entry.metrics["mean"]["Rescaled"].mean for row in rows]
    assert gain.mean == pytest.approx(means[0] - means[1])
    assert gain.low > 0
    assert lead(Row(careless), Row(careless)).high == 0


def test_the_page_has_a_table_a_tier_and_draws_the_first_alone(entries, careless):
    data = page_data(rank_tiers([*entries, careless], {}))
    assert list(data["tiers"]) == ["preferences", "people"]
    people = data["tiers"]["people"]
    assert people["metrics"][:3] == ["H", "Rescaled", "Care"]
    assert list(people["references"]) == list(people["splits"]) == list(PEOPLE.test_splits)
    assert [entry["drawn"] is None for entry in data["entries"]] == [False, True, True]
    shown = data["entries"][1]
    assert shown["metrics"]["mean"].keys() == set(people["metrics"])
    assert len(shown["failure_modes"]["people_three"]) == len(people["failure_modes"])


@pytest.mark.lerobot
@pytest.mark.slow
def test_a_policy_is_submitted_and_its_rerun_confirms_it(kitchen_prefs, tmp_path, capsys):
    rule, out = ("--policy.type=rules", "--policy.rule=people_zone"), tmp_path / "zone"
    submit = ("leaderboard", "submit", "--name=Zone", "--track=standard", "--tier=people", *rule)
    assert kitchen_prefs(*submit, f"--out={out}", "--jobs=1") == 0
    verify = ("leaderboard", "verify", out, "--rerun", "--salt=7", "--jobs=1", *rule)
    folders = (f"--verifications={tmp_path / 'records'}", f"--out={tmp_path / 'reruns'}")
    assert kitchen_prefs(*verify, *folders) == 0
    shown = capsys.readouterr().out
    assert "Second tier: people, all test splits" in shown
    assert "The re-run confirms the submission" in shown
    (entry,) = score_submissions([out], 1)
    (record,) = read_verifications(tmp_path / "records").values()
    assert record.digest == entry.digest
    assert list(record.scores) == list(PEOPLE.test_splits)
    assert record.rerun == record.replayed
    assert record.replayed.mean == pytest.approx(entry.metrics["mean"]["Rescaled"].mean, abs=1e-4)
    (ranked,) = rank_tiers([entry], {record.digest: record})["people"]["standard"]
    assert ranked.rank == 1


@pytest.mark.lerobot
def test_a_policy_that_differs_from_tier_to_tier_is_not_submitted_on_both(kitchen_prefs, tmp_path):
    rule = ("--policy.type=rules", "--policy.rule=random", f"--out={tmp_path / 'out'}")
    tiers = ("--tier=people", "--tier=preferences")
    said = kitchen_prefs("leaderboard", "submit", "--name=R", "--track=standard", *tiers, *rule)
    assert said.endswith("The policy has other settings in each tier; submit one tier at a time.")
    assert not list(tmp_path.iterdir())


@pytest.mark.lerobot
def test_a_policy_of_the_first_tier_is_not_submitted_on_the_second(kitchen_prefs, tmp_path):
    act = f"--policy.path={save_act(tmp_path / 'act')}"
    submit = ("leaderboard", "submit", "--name=ACT", "--track=standard", "--tier=people", act)
    said = kitchen_prefs(*submit, f"--out={tmp_path / 'out'}")
    assert "was trained on 'observation.state' of shape (11,)" in said
    assert [path.name for path in Path(tmp_path).iterdir()] == ["act"]

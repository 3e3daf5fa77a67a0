"""Evaluations of the second tier: its episodes on disk, its tables, and what it does not have."""

import json

import numpy as np
import pytest
from act_checkpoints import call, save_act
from short_splits import short_people_splits

from kitchen_prefs.envs.observations import STATE_SIZE
from kitchen_prefs.envs.people_environment import DishwasherPeople
from kitchen_prefs.evaluation.checkpoint_selection import select_checkpoint
from kitchen_prefs.evaluation.episode_files import read_episodes
from kitchen_prefs.evaluation.evaluator import Evaluator
from kitchen_prefs.metrics.people_episode import PeopleEpisode
from kitchen_prefs.metrics.people_intervals import session_headlines, summarise_people
from kitchen_prefs.metrics.references import people_reference_scores

RANDOM = ("--policy.type=rules", "--policy.rule=random")
ORDER = ("H", "Rescaled", "Care", "Where", "Turn", "Style", "Refused", "Left open", "TE")


@pytest.fixture(autouse=True)
def few_users(few_sessions):
    """Cuts the splits of the second tier down to four sessions."""
    with short_people_splits(4):
        yield


class Imitator:
    """Knows what the expert does in each state of a split's sessions."""

    fingerprint = type = "imitator"
    track = "standard"

    def __init__(self, split):
        environment = DishwasherPeople(split)
        self.known = {}
        for session in range(environment.split.sessions):
            observation, _ = environment.reset(options={"session": session})
            over = False
            while not over:
                action = environment.simulator.expert_action()
                self.known[observation["instances"].tobytes()] = action
                observation, _, over, _, _ = environment.step(action)

    def reset(self):
        pass

    def act(self, observations, tasks):
        default = np.zeros(7, np.float32)
        return np.stack([self.known.get(o["instances"].tobytes(), default) for o in observations])


def evaluate(folder, *arguments):
    return call("evaluate", *RANDOM, f"--out={folder}", *arguments)


def test_imitating_the_expert_reaches_more_than_the_ceiling(tmp_path):
    summary = Evaluator(Imitator("people_val"), tmp_path, batch_size=3).evaluate("people_val")
    assert summary.episodes == 4
    assert summary.wilson_success.mean == 1
    perfect = {"H": 1, "Care": 0, "Where": 1, "Turn": 1, "Style": 1, "Refused": 0, "TE": 1}
    assert {name: summary.metrics[name].mean for name in perfect} == perfect
    assert summary.metrics["Rescaled"].low > 1  # no reader of prompts is always right
    assert set(summary.failure_modes.values()) == {(0, 0)}


def test_the_table_begins_with_the_headline_and_what_hurts_a_person(tmp_path):
    shown = evaluate(tmp_path, "--split=people_val").output
    assert [line.split("│")[1].strip() for line in shown.splitlines() if "│" in line][:9] == [
        *ORDER
    ]
    flat = " ".join(shown.split())
    floor, ceiling = people_reference_scores()["people_val"].values()
    assert f"Rescaled is 0 at the H {floor:.3f} (the rule people_promptless) and 1 at" in flat
    assert f"1 at {ceiling:.3f}" in flat


def test_episodes_are_kept_and_their_summary_is_recomputed_from_them(tmp_path):
    evaluate(tmp_path, "--split=people_three")
    episodes = sorted(read_episodes(tmp_path / "people_three.jsonl"), key=lambda e: e.session)
    assert {type(episode) for episode in episodes} == {PeopleEpisode}
    assert [episode.session for episode in episodes] == list(range(4))
    written = json.loads((tmp_path / "people_three.json").read_text())
    metrics = {name: vars(interval) for name, interval in summarise_people(episodes).items()}
    assert written["metrics"] == metrics
    assert written["conditions"]["data_version"] == 2
    for line in map(json.loads, (tmp_path / "people_three.jsonl").read_text().splitlines()):
        assert line["metrics"]["Where"] == line["alike"] / line["dishes"]


def test_a_killed_evaluation_resumes(tmp_path):
    evaluate(tmp_path / "whole", "--split=people_val", "--batch-size=1")
    file = tmp_path / "whole" / "people_val.jsonl"
    whole = file.read_text()
    file.write_text("".join(whole.splitlines(keepends=True)[:2]) + '{"split"')
    evaluate(tmp_path / "whole", "--split=people_val", "--batch-size=1")
    assert file.read_text() == whole


def test_splits_of_both_tiers_have_a_table_each(tmp_path):
    shown = evaluate(tmp_path, "--split=people_val,val,people_evening,people_val").output
    assert shown.count("Success with its") == 3
    assert shown.count("mean of the splits") == 2  # both tables of the second tier alone
    val, people = (json.loads((tmp_path / f"{n}.json").read_text()) for n in ("val", "people_val"))
    assert "Score" in val["metrics"]
    assert "H" in people["metrics"]


@pytest.mark.parametrize(
    "wrong", ["--track=privileged", "--prompts=2", "--prompt-use", "--category-accuracy"]
)
def test_what_the_second_tier_does_not_have_is_said_before_anything_is_rolled_out(tmp_path, wrong):
    out = tmp_path / "out"
    with pytest.raises(ValueError, match=r"tier 'people' has the standard track .* leave out"):
        evaluate(out, "--split=people_val", wrong)
    assert not out.exists()


def test_a_misspelt_split_is_named_with_the_nearest(tmp_path):
    with pytest.raises(ValueError, match=r"no split 'people_unsen'\. Did you mean 'people_unseen'"):
        evaluate(tmp_path, "--split=people_unsen")


def test_select_names_the_checkpoint_with_the_highest_headline(tmp_path):
    for seed, step in enumerate(("000100", "000200")):
        folder = tmp_path / "checkpoints" / step / "pretrained_model"
        save_act(folder, seed, state_size=STATE_SIZE + 1)
    assert "The best by H is" in call("select", str(tmp_path), "--split=people_val").output
    selection = json.loads((tmp_path / "selection.json").read_text())
    headline = {step: metrics["H"]["mean"] for step, metrics in selection["checkpoints"].items()}
    assert len(set(headline.values())) == 2
    best = max(headline, key=lambda step: headline[step])
    assert selection["best"] == f"checkpoints/{best}/pretrained_model"


def test_a_checkpoint_of_the_first_tier_does_not_fit(tmp_path):
    path = save_act(tmp_path / "act")
    with pytest.raises(ValueError, match=r"'observation.state' of shape \(11,\); .* has \(12,\)"):
        call("evaluate", f"--policy.path={path}", "--split=people_val", f"--out={tmp_path / 'out'}")


def test_checkpoints_are_not_chosen_on_a_test_split(tmp_path):
    with pytest.raises(ValueError, match="give --split=val or --split=people_val"):
        select_checkpoint(tmp_path, split="people_unseen")


def test_what_sessions_contribute_comes_to_the_rescaled_headline(tmp_path):
    evaluate(tmp_path, "--split=people_val,people_partial,people_polls")
    for split in ("people_val", "people_partial", "people_polls"):
        episodes = read_episodes(tmp_path / f"{split}.jsonl")
        rescaled = summarise_people(episodes)["Rescaled"]
        assert np.mean(session_headlines(episodes)) == pytest.approx(rescaled.mean)

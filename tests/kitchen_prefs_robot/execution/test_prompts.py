"""Prompts: what --demonstration names, and how a demonstration was understood."""

import json

import pytest

pytest.importorskip("gym_hil", reason="needs the extra robot")

from kitchen_prefs_robot.demonstrations.recording import HumanDemonstration
from kitchen_prefs_robot.execution import prompts
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.prompts import NotUnderstoodError, prompt_for, prompt_from
from kitchen_prefs_robot.execution.trials import Trial, run_trial
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.sessions import make_session


@pytest.fixture
def folder(tmp_path):
    """A data set as far as its first file says what it shows."""
    file = tmp_path / "meta" / "demonstrations.json"
    file.parent.mkdir()
    file.write_text(json.dumps({"episodes": [{"scene": 4, "preference": 2, "dishes": []}]}))
    return tmp_path


@pytest.mark.parametrize("episode", ["abc", "-1", "", "1.0", "²"])
def test_an_episode_is_a_number(folder, episode):
    with pytest.raises(ValueError, match="FOLDER or FOLDER:EPISODE with a number from 0"):
        prompt_from(f"{folder}:{episode}", 3, 2)


@pytest.mark.parametrize(
    ("episode", "scene", "preference", "sentence"),
    [
        (0, 3, 0, "shows preference 2, not 0; give --preference=2"),
        (0, 4, 2, "shows scene 4 itself; give another --scene"),
        (1, 3, 2, "There is no episode 1 in"),
    ],
)
def test_another_preference_and_the_very_scene_are_refused(
    folder, episode, scene, preference, sentence
):
    with pytest.raises(ValueError, match=sentence):
        prompt_from(f"{folder}:{episode}", scene, preference)


@pytest.mark.parametrize("text", ["", "[]", '{"episodes": [{"scene": 1}]}', '{"episodes": 3}'])
def test_a_damaged_data_set_is_one_sentence(folder, text):
    (folder / "meta" / "demonstrations.json").write_text(text)
    with pytest.raises(ValueError, match="is damaged or no data set of these demonstrations"):
        prompt_from(str(folder), 3, 2)


def test_a_person_who_is_not_understood_shows_it_again(monkeypatch):
    shown, seen_with = demonstrate(make_session("test", 0)), []

    def record(scene, preference, *conditions):
        seen_with.append((scene, *conditions))
        if len(seen_with) < 3:
            raise ValueError("dishes touch")
        taken_for = ((None, None), ("small plate", "cup"), ("cup", "cup"))
        return HumanDemonstration(scene, preference, {}, shown.sets, shown.chosen, taken_for)

    monkeypatch.setattr(prompts, "record", record)
    prompt = prompt_for(7, 0, Conditions(lamp=0.123, camera_error=0.004))
    assert (prompt.rows == shown.prompt).all()
    assert (prompt.shown, prompt.misread) == (3, (("cup", "small plate"),))
    conditions = ("distinct", 0.123, 1.0, 0.004)
    assert seen_with == [(scene, *conditions) for scene in (100_007, 200_007, 300_007)]


def test_a_trial_in_which_nothing_is_understood_fails_by_the_demonstration(monkeypatch):
    def record(*_):
        raise ValueError("dishes touch")

    monkeypatch.setattr(prompts, "record", record)
    outcome = run_trial(None, Trial(7, 0), Conditions(lamp=0.124))
    assert (outcome.right, outcome.shown, outcome.causes) == (0.0, 3, {"demonstration": 4})
    with pytest.raises(NotUnderstoodError, match=r"give another --scene\. dishes touch$"):
        prompt_for(7, 0, Conditions(lamp=0.124))

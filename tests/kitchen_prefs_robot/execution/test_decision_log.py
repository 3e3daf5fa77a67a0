"""The video of an episode, looked at, and its log."""

import json
from dataclasses import replace

import av
import numpy as np
import pytest

pytest.importorskip("gym_hil", reason="needs the extra robot")

from kitchen_prefs_robot.demonstrations.preferences import HUMAN_PREFERENCES
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.decision_log import (
    BAR,
    SIZE,
    DecisionLog,
    _captioned,
    in_words,
    write_video,
)
from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.looking import TrueEyes
from kitchen_prefs_robot.perception.clusters import Box
from kitchen_prefs_robot.perception.detection import Touching
from kitchen_prefs_robot.task.decisions import Pick, Place, Toggle
from kitchen_prefs_robot.task.state import DrawersState, SeenDish

CUP = SeenDish("cup", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), None)


def test_a_decision_is_said_in_words():
    state = DrawersState((CUP,), "upper", None)
    assert in_words(state, Toggle("upper")) == "close the upper drawer"
    assert in_words(state, Toggle("lower")) == "open the lower drawer"
    assert in_words(state, Pick(0)) == "pick the cup"
    held = DrawersState((), "upper", "cup")
    assert in_words(held, Place("upper")) == "drop the cup into the upper drawer"


def test_a_video_shows_its_frames_above_the_caption(tmp_path):
    red = np.full((SIZE[1], SIZE[0], 3), (200, 30, 30), np.uint8)
    frames = [_captioned(red, ("Load the upper drawer with cups.", "Decision 1"))] * 3
    write_video(frames, tmp_path / "video.mp4")
    with av.open(str(tmp_path / "video.mp4")) as video:
        seen = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
    assert [frame.shape for frame in seen] == [(SIZE[1] + BAR, SIZE[0], 3)] * 3
    assert np.abs(seen[1][: SIZE[1] - 8].astype(int) - (200, 30, 30)).max() < 25
    bar = seen[1][SIZE[1] + 4 :]
    assert bar.min() < 70
    assert bar.max() > 180  # there is something to read


@pytest.mark.parametrize("preference", HUMAN_PREFERENCES)
def test_the_longest_caption_fits(preference):
    words = (
        preference.in_words,
        "Decision 24 of at most 24: drop the small plate into the upper drawer",
    )
    bar = np.asarray(_captioned(np.zeros((8, SIZE[0], 3), np.uint8), words).convert("L"))[8:]
    assert bar[:, :-6].max() > 180
    assert bar[:, -6:].max() < 60
    assert bar[-4:].max() < 60


def test_dishes_that_touch_are_in_the_log(tmp_path, monkeypatch):
    touching = Touching("counter", Box(np.zeros(3), np.array([0.3, 0.2, 0.1]), 0.0))
    look = TrueEyes.look
    monkeypatch.setattr(TrueEyes, "look", lambda eyes: replace(look(eyes), touching=(touching,)))
    given = Conditions(perception="truth", grasps="truth")
    with RobotEpisode(3, HUMAN_PREFERENCES[0], given) as episode:
        log = DecisionLog(tmp_path)
        log.look(episode)
        episode.decide(Toggle("upper"))
        log.look(episode)
    (line,) = (tmp_path / "decisions.jsonl").read_text().splitlines()
    assert "move them apart" in json.loads(line)["touching"][0]

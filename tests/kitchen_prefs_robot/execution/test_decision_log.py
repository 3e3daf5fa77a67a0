"""The video of an episode, looked at, and its log."""

import json
from dataclasses import replace

import av
import numpy as np
import pytest
from PIL import Image

pytest.importorskip("gym_hil", reason="needs the extra robot")

from kitchen_prefs.rendering.opengl import NoOpenGLError
from kitchen_prefs_robot.demonstrations.preferences import HUMAN_PREFERENCES
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.decision_log import EVERY, SIZE, DecisionLog, in_words
from kitchen_prefs_robot.execution.episode import RobotEpisode
from kitchen_prefs_robot.execution.looking import TrueEyes
from kitchen_prefs_robot.execution.video import BAR, Video, captioned
from kitchen_prefs_robot.perception.cloud import Frame
from kitchen_prefs_robot.perception.clusters import Box
from kitchen_prefs_robot.perception.detection import Touching
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.task.decisions import Pick, Place, Toggle
from kitchen_prefs_robot.task.state import DrawersState, SeenDish

GIVEN = Conditions(perception="truth", grasps="truth")
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
    video = Video(tmp_path / "video.mp4", *SIZE)
    for _ in range(3):
        video.add(red, "Load the upper drawer with cups.", "Decision 1")
    video.close()
    with av.open(str(tmp_path / "video.mp4")) as video:
        seen = [frame.to_ndarray(format="rgb24") for frame in video.decode(video=0)]
    assert [frame.shape for frame in seen] == [(SIZE[1] + BAR, SIZE[0], 3)] * 3
    assert np.abs(seen[1][: SIZE[1] - 8].astype(int) - (200, 30, 30)).max() < 25
    bar = seen[1][SIZE[1] + 4 :]
    assert bar.min() < 70
    assert bar.max() > 180  # there is something to read


@pytest.mark.parametrize("preference", HUMAN_PREFERENCES)
def test_the_longest_caption_fits(preference):
    longest = "Decision 24 of at most 24: drop the small plate into the upper drawer"
    page = captioned(np.zeros((8, SIZE[0], 3), np.uint8), preference.in_words, longest)
    bar = np.asarray(page.convert("L"))[8:]
    assert bar[:, :-6].max() > 180
    assert bar[:, -6:].max() < 60
    assert bar[-4:].max() < 60


def test_dishes_that_touch_are_in_the_log(tmp_path, monkeypatch):
    touching = Touching("counter", Box(np.zeros(3), np.array([0.3, 0.2, 0.1]), 0.0))
    look = TrueEyes.look
    monkeypatch.setattr(TrueEyes, "look", lambda eyes: replace(look(eyes), touching=(touching,)))
    with DecisionLog(tmp_path) as log, RobotEpisode(3, HUMAN_PREFERENCES[0], GIVEN) as episode:
        log.look(episode)
        episode.decide(Toggle("upper"))
        log.look(episode)
    (line,) = (tmp_path / "decisions.jsonl").read_text().splitlines()
    assert json.loads(line)["decision"] == 1
    assert "move them apart" in json.loads(line)["touching"][0]


def test_pictures_count_from_1_and_are_new_while_a_dish_is_in_hand(tmp_path, monkeypatch):
    taken = []

    def take(_):
        taken.append(1)
        colour = np.full((24, 32, 3), 10 * len(taken), np.uint8)
        return {"front": Frame(colour, np.zeros((24, 32)), np.eye(3))}

    look = TrueEyes.look
    monkeypatch.setattr(TrueEyes, "take", take)
    monkeypatch.setattr(TrueEyes, "look", lambda eyes: replace(look(eyes), frames=take(eyes)))
    poses = {"front": np.eye(4)}
    monkeypatch.setattr(
        "kitchen_prefs_robot.execution.decision_log.laboratory_poses", lambda: poses
    )
    with DecisionLog(tmp_path) as log, RobotEpisode(3, HUMAN_PREFERENCES[0], GIVEN) as episode:
        for decision in (Toggle("upper"), Pick(0)):
            log.look(episode)
            episode.decide(decision)
        log.look(episode)
        assert episode.state.in_hand
    seen = {path.name: np.asarray(Image.open(path))[0, 0, 0] for path in tmp_path.glob("looks/*")}
    assert seen == {"01.png": 10, "02.png": 20, "03.png": 30}


def fail_while_watching(folder):
    world = World(sample_scene(0, dishes=()))
    with DecisionLog(folder) as log:
        for _ in range(EVERY):
            log.frame(world)
        raise RuntimeError("the arm")


def test_the_video_is_whole_where_an_episode_fails(tmp_path):
    try:
        with pytest.raises(RuntimeError, match="the arm"):
            fail_while_watching(tmp_path)
    except NoOpenGLError:
        pytest.skip("needs EGL")
    with av.open(str(tmp_path / "episode.mp4")) as video:
        assert len(list(video.decode(video=0))) == 1

"""The video of an episode, looked at."""

import av
import numpy as np
import pytest
from PIL import Image

pytest.importorskip("gym_hil", reason="needs the extra robot")

from kitchen_prefs_robot.execution.decision_log import BAR, SIZE, _captioned, in_words, write_video
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


@pytest.mark.parametrize("words", ["cups", "the upper drawer with " + "small plates, then " * 6])
def test_a_caption_fits(words):
    picture = _captioned(np.zeros((40, 300, 3), np.uint8), (words, words))
    right_edge = np.asarray(picture.convert("L"))[40:, -4:]
    assert isinstance(picture, Image.Image)
    assert right_edge.max() < 60 or len(words) > 100

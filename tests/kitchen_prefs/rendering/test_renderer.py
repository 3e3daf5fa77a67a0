import os
import subprocess
import sys

import numpy as np
import pytest

from kitchen_prefs.rendering.renderer import Renderer
from kitchen_prefs.rendering.state import SceneDish, SceneState
from kitchen_prefs.simulation.layout import COUNTER_HEIGHT, SINK_POSITION

pytestmark = pytest.mark.xdist_group("renderer")  # one fixture of the module serves all

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])


@pytest.fixture(scope="module")
def renderer():
    renderer = Renderer(320, 240, "fast")
    yield renderer
    renderer.close()


def changed(first: np.ndarray, second: np.ndarray) -> float:
    return float((np.abs(first.astype(int) - second).max(axis=-1) > 20).mean())


def test_a_picture_has_the_size_asked_for_and_shows_something(renderer):
    picture = renderer.render(SceneState())
    assert picture.shape == (240, 320, 3)
    assert picture.dtype == np.uint8
    assert picture.std() > 10


def test_the_same_state_gives_the_same_picture(renderer):
    first = renderer.render(SceneState())
    renderer.render(SceneState(door_open=True, top_out=True))
    assert np.array_equal(first, renderer.render(SceneState()))


def test_door_and_racks_show(renderer):
    closed = renderer.render(SceneState())
    opened = renderer.render(SceneState(door_open=True))
    bottom = renderer.render(SceneState(door_open=True, bottom_out=True))
    top = renderer.render(SceneState(door_open=True, top_out=True))
    assert changed(closed, opened) > 0.02
    assert changed(opened, bottom) > 0.005
    assert changed(opened, top) > 0.005
    assert changed(bottom, top) > 0.005


def test_a_dish_shows_where_it_stands(renderer):
    position = np.array([-1.6, 0.3, COUNTER_HEIGHT + 0.05])
    empty = renderer.render(SceneState())
    laid = renderer.render(SceneState(dishes=(SceneDish("big bowl", position, UPRIGHT),)))
    rows, columns = np.nonzero(np.abs(laid.astype(int) - empty).max(axis=-1) > 20)
    assert len(rows) > 50
    assert columns.max() < 160  # left of the sink is the left half of the picture
    assert rows.max() < 160


def test_two_dishes_in_the_sink_are_both_seen(renderer):
    sunk = SceneDish("big plate", np.array(SINK_POSITION), UPRIGHT)
    one = renderer.render(SceneState(dishes=(sunk,)))
    two = renderer.render(SceneState(dishes=(sunk, sunk)))
    assert changed(one, two) > 0


def test_renderers_do_not_disturb_each_other(renderer):
    alone = renderer.render(SceneState())
    other = Renderer(64, 48, "fast")
    assert other.render(SceneState()).shape == (48, 64, 3)
    other.close()
    assert np.array_equal(alone, renderer.render(SceneState()))


def test_an_unknown_quality_is_named():
    with pytest.raises(ValueError, match=r"fast.*fine.*'best'"):
        Renderer(64, 48, "best")


def test_without_opengl_one_sentence_names_the_packages():
    code = (
        "from kitchen_prefs.rendering.renderer import Renderer\n"
        "try:\n    Renderer(64, 48, 'fast')\n"
        "except OSError as error:\n    print(error)\n"
    )
    # A driver manifest that does not exist leaves EGL without any device to draw on.
    missing = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nowhere.json"}
    ran = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | missing,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "libegl1 libegl-mesa0 libgl1-mesa-dri" in ran.stdout, ran.stderr

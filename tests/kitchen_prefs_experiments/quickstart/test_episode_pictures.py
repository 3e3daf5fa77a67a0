"""Pictures of an episode."""

import numpy as np
import pytest
from PIL import Image

from kitchen_prefs_experiments.quickstart.episode_pictures import draw_episode


@pytest.mark.slow
def test_the_pictures_show_the_counter_cleared_and_the_racks_loaded(tmp_path, episodes):
    draw_episode(episodes[0], tmp_path)
    start, end = (
        np.asarray(Image.open(tmp_path / f"{n}.png")).astype(int) for n in ("start", "end")
    )
    changed = np.abs(start - end).max(axis=-1) > 40
    assert start.shape == end.shape == (960, 1280, 3)
    assert changed[270:380, 150:520].mean() > 0.01  # dishes stood on the counter's left end
    assert changed[450:900, 600:960].mean() > 0.2  # the racks are pulled out, with dishes in them
    assert changed[0:80].mean() < 0.001  # the wall is the same
    animation = Image.open(tmp_path / "episode.gif")
    assert animation.n_frames > len(episodes[0].actions) / 2

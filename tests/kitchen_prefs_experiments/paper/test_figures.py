"""The pictures of tables."""

import numpy as np
import pytest
from PIL import Image

from kitchen_prefs_experiments.paper.figures import COLOURS, draw
from kitchen_prefs_experiments.paper.paper_tables import TABLES


@pytest.mark.parametrize(
    ("name", "ours"), [("main", 7), ("attributes", 1), ("finetuning", 2), ("seeds", 3)]
)
def test_a_picture_shows_our_means_and_the_papers_values(tmp_path, made_up_results, name, ours):
    table = TABLES[name]
    draw(table, made_up_results(name), tmp_path / "table.png")
    pixels = np.asarray(Image.open(tmp_path / "table.png").convert("RGB")).astype(int)
    for colour in (*COLOURS[:ours], *["#000000"] * bool(table.paper_values)):
        red_green_blue = [int(colour[i : i + 2], 16) for i in (1, 3, 5)]
        assert (np.abs(pixels - red_green_blue).sum(axis=-1) < 20).sum() > 200

"""The figure of four users: whole, and its captions say what the users do."""

from itertools import pairwise

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line
from kitchen_prefs.people.attributes import CLASSES
from kitchen_prefs.people.zones import ZONES
from kitchen_prefs_experiments.people.figure import CAPTION, GAP, HEIGHT, USERS, WIDTH


@pytest.mark.parametrize(("caption", "user"), USERS.items(), ids=[words[0] for words in USERS])
def test_captions_name_the_zones_in_the_order_of_the_classes(caption, user):
    words = " ".join(caption[1:]).lower()
    for name, zone in zip(CLASSES[user.base.scheme], user.base.values, strict=True):
        assert ZONES[zone] in words.split(name, 1)[1].split(".")[0]


def test_a_figure_that_is_no_png_file_is_refused_before_anything_is_drawn(tmp_path):
    done = CliRunner().invoke(command_line(), ["people", "figure", f"--out={tmp_path / 'a.jpg'}"])
    assert done.exit_code == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_the_command_draws_racks_that_differ(tmp_path):
    file = tmp_path / "people.png"
    done = CliRunner().invoke(command_line(), ["people", "figure", f"--out={file}"])
    assert done.exit_code == 0, done.output
    picture = np.asarray(Image.open(file).convert("RGB")).astype(int)
    racks = [
        picture[CAPTION : CAPTION + HEIGHT, left : left + WIDTH]
        for left in range(0, picture.shape[1], WIDTH + GAP)
    ]
    assert len(racks) == len(USERS)
    for first, second in pairwise(racks):
        assert (np.abs(first - second).max(axis=-1) > 30).mean() > 0.05

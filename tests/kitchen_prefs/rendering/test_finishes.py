"""Dishes of the second tier in pictures: each attribute is seen."""

import numpy as np
import pytest

from kitchen_prefs.people.attributes import COMES_IN, MATERIALS
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.rendering.renderer import Renderer
from kitchen_prefs.rendering.state import Look, SceneDish, SceneState

pytestmark = pytest.mark.xdist_group("finishes")  # one fixture of the module serves all

UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
MIDDLE = np.array([0.0, -0.29, 0.55])  # of what the camera above the top rack sees
BELOW = MIDDLE - [0.0, 0.0, 0.1]


@pytest.fixture(scope="module")
def picture():
    """Draws dishes where the top rack would be."""
    renderer = Renderer(160, 120, "fast", "top")

    def draw(*dishes):
        placed = tuple(SceneDish(category, at, UPRIGHT, look) for category, at, look in dishes)
        return renderer.render(SceneState(dishes=placed)).astype(int)

    yield draw
    renderer.close()


def seen(picture, *dishes):
    """Which pixels the dishes change, (H, W) bool."""
    return np.abs(picture(*dishes) - picture()).max(axis=-1) > 12


def mean_colour(picture, category, look):
    dish = (category, MIDDLE, look)
    return picture(dish)[seen(picture, dish)].mean(axis=0)


@pytest.mark.parametrize("material", MATERIALS)
def test_a_dish_has_its_colour_on_every_material(picture, material):
    red, _, blue = mean_colour(picture, "small bowl", Look(material, "red")) - mean_colour(
        picture, "small bowl", Look(material, "blue")
    )
    assert red > 20
    assert blue < -20


def test_materials_of_one_colour_differ(picture):
    drawn = [picture(("big bowl", MIDDLE, Look(name, "green"))) for name in MATERIALS]
    dish = seen(picture, ("big bowl", MIDDLE, Look("ceramic", "green")))
    for first in range(len(MATERIALS)):
        for second in range(first):
            difference = np.abs(drawn[first] - drawn[second])[dish].max(axis=-1)
            assert (difference > 20).mean() > 0.2, (MATERIALS[first], MATERIALS[second])


@pytest.mark.parametrize(("material", "is_clear"), [("glass", True), ("ceramic", False)])
def test_what_is_behind_a_dish_is_seen_through_glass_alone(picture, material, is_clear):
    bowl = ("big bowl", MIDDLE, Look(material, "white"))
    before = [
        picture(bowl, ("tray", BELOW, Look("plastic", colour)))[55:65, 75:85]
        for colour in ("red", "green")
    ]
    assert (np.abs(before[0] - before[1]).max() > 40) == is_clear


@pytest.mark.parametrize(
    ("category", "material"), [(name, one) for name in CATEGORIES for one in COMES_IN[name]]
)
def test_greasy_dishes_have_dark_stains(picture, category, material):
    clean, greasy = ((category, MIDDLE, Look(material, "white", soil)) for soil in (False, True))
    dish = seen(picture, clean)
    darker = (picture(clean) - picture(greasy))[dish].max(axis=-1)
    assert 0.08 < (darker > 50).mean() < 0.6


def test_a_dish_is_drawn_to_scale(picture):
    small, large = (
        seen(picture, ("big plate", MIDDLE, Look("plastic", "red", scale=scale))).sum()
        for scale in (0.85, 1.15)
    )
    assert large / small == pytest.approx((1.15 / 0.85) ** 2, rel=0.1)


def test_an_unknown_view_is_named():
    with pytest.raises(ValueError, match=r"bottom.*sink.*'side'"):
        Renderer(64, 48, "fast", "side")

"""Recipes by name."""

import pytest

from kitchen_prefs_experiments.recipes import recipe_file


def test_a_recipe_that_does_not_exist_suggests_the_nearest():
    with pytest.raises(ValueError, match="Did you mean 'ttp_quick'"):
        recipe_file("ttp_quik")

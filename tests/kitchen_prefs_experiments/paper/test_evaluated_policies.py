"""The policies of the tables: their data sets, their settings and their names."""

from dataclasses import fields

import pytest
import yaml
from lerobot.configs import PreTrainedConfig
from lerobot.utils.import_utils import register_third_party_plugins

from kitchen_prefs.datasets.names import content_of
from kitchen_prefs_experiments.paper.evaluated_policies import BASE, RECIPE, FineTuning, Training
from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.table_types import Table
from kitchen_prefs_experiments.recipes import recipe_file


def trainings():
    tables = [table for table in TABLES.values() if isinstance(table, Table)]
    policies = [policy for table in tables for policy in table.policies]
    return [policy for policy in policies if isinstance(policy, Training)]


def test_a_budget_below_one_batch_is_refused():
    with pytest.raises(ValueError, match="greater --budget"):
        BASE.steps(31)


def test_every_training_has_its_data_set_and_its_settings():
    register_third_party_plugins()
    for policy in (*trainings(), *FineTuning(BASE, 1).trainings):
        content_of(policy.dataset)
        recipe = yaml.safe_load(recipe_file(policy.recipe).read_text())
        config = PreTrainedConfig.get_choice_class(recipe["policy"]["type"])
        for override in policy.overrides:
            if override.startswith("--policy."):
                setting = override.removeprefix("--policy.").partition("=")[0]
                assert setting in {field.name for field in fields(config)}


def test_trainings_of_one_name_are_one_training():
    assert len({policy.name for policy in trainings()}) == len(set(trainings()))


def test_the_recipe_is_what_the_base_rows_are_called():
    recipe = yaml.safe_load(recipe_file(RECIPE).read_text())
    policy = recipe["policy"]
    assert recipe["batch_size"] == BASE.batch_size == 32
    assert recipe["dataset"]["repo_id"] == f"kitchen_prefs/{BASE.dataset}"
    assert policy["time_encoding"] == "fourier"
    assert policy.get("extents_encoding", "fourier") == "fourier"
    assert policy.get("pose_encoding", "fourier") == "fourier"
    assert not policy.get("hidden")

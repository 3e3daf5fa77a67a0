"""TTP's configuration: what is refused, and the two that recipes train."""

from dataclasses import asdict
from pathlib import Path

import pytest
import yaml
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.optim import AdamWConfig

from kitchen_prefs.instances import CAPACITY
from lerobot_policy_kitchen_prefs.gnn import GNNConfig
from lerobot_policy_kitchen_prefs.ttp import TTPPolicy
from lerobot_policy_kitchen_prefs.ttp.configuration_ttp import TTPConfig
from lerobot_policy_kitchen_prefs.ttp.scheduler import ExponentialDecaySchedulerConfig

RECIPES = Path(__file__).parents[3] / "policies/recipes"


@pytest.mark.parametrize(
    ("inputs", "output"),
    [({}, 7), ({"observation.instances": 12}, 7), ({"observation.instances": 13}, 6)],
)
def test_features_that_do_not_fit_are_named(inputs, output):
    config = TTPConfig(
        device="cpu",
        input_features={
            name: PolicyFeature(FeatureType.STATE, (CAPACITY, n)) for name, n in inputs.items()
        },
        output_features={"action": PolicyFeature(FeatureType.ACTION, (output,))},
    )
    name = "action" if output == 6 else r"observation\.instances"
    with pytest.raises(ValueError, match=name):
        TTPPolicy(config)


@pytest.mark.parametrize(
    "settings",
    [
        {"pointer": "rows"},
        {"prompt_tokens": "all"},
        {"dtype": "float16"},
        {"n_heads": 3},
        {"rounds": 0},
        {"context_history": -1},
        {"hidden": ["colour"]},
    ],
)
def test_impossible_settings_are_refused(settings):
    with pytest.raises(ValueError, match=next(iter(settings)).removeprefix("n_")):
        TTPConfig(device="cpu", **settings)


def recipe(name):
    """The policy of a recipe, without where it runs and how fast it computes."""
    settings = yaml.safe_load((RECIPES / f"{name}.yaml").read_text())["policy"]
    return {
        key: value
        for key, value in settings.items()
        if key not in ("type", "device", "push_to_hub", "dtype", "optimizer", "scheduler")
    }


@pytest.mark.parametrize(
    ("config", "name"),
    [(TTPConfig.paper, "ttp_paper"), (TTPConfig.compact, "ttp_quick")],
)
def test_the_named_configurations_are_those_of_the_recipes(config, name):
    assert asdict(config(device="cpu")) == asdict(TTPConfig(device="cpu", **recipe(name)))


@pytest.mark.parametrize("name", ["ttp_paper", "ttp_quick", "ttp_final", "gnn_paper", "gnn_tuned"])
def test_a_recipe_saves_its_own_optimiser_as_the_preset_at_a_tenth_of_the_learning_rate(name):
    recipe = yaml.safe_load((RECIPES / f"{name}.yaml").read_text())
    trains, preset = recipe["optimizer"], recipe["policy"]["optimizer"]
    assert preset["lr"] == pytest.approx(trains["lr"] / 10)
    assert preset | {"lr": 0} == trains | {"lr": 0}


@pytest.mark.parametrize("config", [TTPConfig, GNNConfig])
def test_an_optimiser_is_the_preset_and_the_papers_settings_beside_it_are_refused(config):
    adamw = AdamWConfig(lr=0.5)
    assert config(device="cpu", optimizer=adamw).get_optimizer_preset() is adamw
    assert config(device="cpu", optimizer=adamw).get_scheduler_preset() is None
    with pytest.raises(ValueError, match=r"adamw, so optimizer_lr has no effect; .*optimizer\.lr"):
        config(device="cpu", optimizer=adamw, optimizer_lr=0.1)
    with pytest.raises(ValueError, match="A scheduler belongs to an optimizer"):
        config(device="cpu", scheduler=ExponentialDecaySchedulerConfig())


def test_a_named_configuration_takes_changes():
    assert TTPConfig.compact(device="cpu", rounds=2).rounds == 2
    assert TTPConfig.paper(device="cpu", num_slots=7).num_slots == 7


def test_only_the_compact_network_departs_from_the_paper():
    assert not TTPConfig.paper(device="cpu", context_history=2).departs_from_paper
    assert TTPConfig.compact(device="cpu").departs_from_paper

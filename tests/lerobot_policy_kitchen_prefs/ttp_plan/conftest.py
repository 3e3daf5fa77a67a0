"""A small data set of the second tier, and tiny policies."""

import pytest
import torch
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.datasets import LeRobotDataset
from tiny_ttp import TINY

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.instances import DESCRIBED_CAPACITY, DESCRIBED_COLUMNS
from lerobot_policy_kitchen_prefs.ttp_plan import PlanTTPConfig, PlanTTPPolicy

NAME = "dishwasher-people_train-u2-v2"
SMALL_READER = {"reader_dim": 32, "reader_layers": 2, "reader_feedforward": 32}


@pytest.fixture(scope="session")
def people_dataset(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(tmp_path_factory.mktemp("home")))
        root = make_dataset(NAME)
    return LeRobotDataset(f"kitchen_prefs/{NAME}", root=root)


@pytest.fixture
def make_policy():
    def make(dataset=None, **settings):
        shape = (DESCRIBED_CAPACITY, DESCRIBED_COLUMNS)
        config = PlanTTPConfig(
            input_features={"observation.instances": PolicyFeature(FeatureType.STATE, shape)},
            output_features={"action": PolicyFeature(FeatureType.ACTION, (7,))},
            **TINY | SMALL_READER | settings,
        )
        torch.manual_seed(0)
        return PlanTTPPolicy(config, dataset_meta=dataset.meta if dataset else None)

    return make

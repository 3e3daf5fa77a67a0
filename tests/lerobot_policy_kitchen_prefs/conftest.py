"""A small data set, demonstrations of four sessions, and decisions paired with prompts."""

import numpy as np
import pytest
import torch
from lerobot.datasets import LeRobotDataset

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.datasets.demonstration_store import PLACE, DemonstrationStore
from kitchen_prefs.envs.demonstrations import demonstrate, prompt_of
from kitchen_prefs.instances import IS_PLACE, is_place_decision, is_real, unpad
from kitchen_prefs.simulation.sessions import make_session
from lerobot_policy_kitchen_prefs.common.categories import Categories
from lerobot_policy_kitchen_prefs.common.instance_sets import chosen_rows
from lerobot_policy_kitchen_prefs.common.rack_poses import RackPoses
from lerobot_policy_kitchen_prefs.ttp.prompt_pairing import make_pairs

NAME = "dishwasher-train-p2-d3-v1"  # two preferences, three demonstrations each


@pytest.fixture(scope="session")
def dataset(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(tmp_path_factory.mktemp("home")))
        root = make_dataset(NAME)
    return LeRobotDataset(f"kitchen_prefs/{NAME}", root=root)


@pytest.fixture(scope="session")
def sessions():
    return [make_session("val", index) for index in (0, 1, 10, 11)]


@pytest.fixture(scope="session")
def demonstrations(sessions):
    rows = [unpad(prompt_of(session)) for session in sessions]
    labels = np.array([session.label for session in sessions])
    lengths = np.array([len(r) for r in rows])
    rows = np.concatenate(rows)
    places = np.unique(rows[rows[:, IS_PLACE] > 0][:, PLACE], axis=0)
    return DemonstrationStore(rows, lengths, labels, places)


@pytest.fixture(scope="session")
def categories(demonstrations):
    return Categories.from_demonstrations(demonstrations)


@pytest.fixture(scope="session")
def rack_poses(demonstrations, categories):
    return RackPoses.from_demonstrations(demonstrations, categories)


@pytest.fixture(scope="session")
def pairs(sessions, demonstrations):
    """All decisions of the first two sessions, each pick with three prompts."""
    parts = [demonstrate(session) for session in sessions[:2]]
    sets = torch.from_numpy(np.concatenate([part.instances for part in parts]))
    actions = torch.from_numpy(np.concatenate([part.action for part in parts]))
    episodes = np.repeat([0, 1], [len(part.action) for part in parts])
    generator = np.random.default_rng(0)
    return make_pairs(sets, chosen_rows(sets, actions), episodes, demonstrations, 3, generator)


@pytest.fixture(scope="session")
def place_sets(pairs):
    """Sets of place decisions, as many rows as the longest has, (B, N, 13)."""
    sets = pairs.sets[is_place_decision(pairs.sets)]
    return sets[:, : int(is_real(sets).sum(dim=1).max())]

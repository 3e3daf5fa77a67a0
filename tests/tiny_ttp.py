"""Tiny TTP policies, and the batches and observations that tests give them."""

import numpy as np
import pytest
import torch
from lerobot.configs import FeatureType, PolicyFeature

from kitchen_prefs.envs.demonstrations import demonstrate, prompt_of
from kitchen_prefs.instances import CAPACITY, COLUMNS, choosable
from kitchen_prefs.simulation.sessions import make_session, prompt_session
from lerobot_policy_kitchen_prefs.ttp import TTPConfig, TTPPolicy
from lerobot_policy_kitchen_prefs.ttp.network import Situations
from lerobot_policy_kitchen_prefs.ttp.prompt_tokens import tokens_of_prompts

TINY = {
    "dim_pose": 16,
    "dim_extents": 8,
    "dim_time": 4,
    "dim_marker": 4,
    "dim_feedforward": 32,
    "num_slots": 5,
    "device": "cpu",
}

PAPER: dict = {}

# All that departs from the paper, as in the recipe ttp_plus.
COMPACT = {
    "prompt_tokens": "chosen",
    "use_slots": False,
    "relabel": True,
    "rounds": 3,
    "pre_norm": True,
    "pointer": "outputs",
    "situation_time": False,
    "time_encoding": "fourier",
    "geometric_attention": True,
    "clashes": True,
    "failures": True,
    "recognise": True,
}

FINAL = COMPACT | {"prompt_tokens": "final"}

OTHER_ENCODINGS = {"pose_encoding": "linear", "extents_encoding": "label"}

BOTH = pytest.mark.parametrize("settings", [PAPER, COMPACT], ids=["paper", "compact"])


def make_policy(dataset=None, **settings):
    """A tiny policy, with the same weights each time."""
    instances = PolicyFeature(FeatureType.STATE, (CAPACITY, COLUMNS))
    config = TTPConfig(
        input_features={"observation.instances": instances},
        output_features={"action": PolicyFeature(FeatureType.ACTION, (7,))},
        **{**TINY, **settings},
    )
    torch.manual_seed(0)
    return TTPPolicy(config, dataset_meta=dataset.meta if dataset else None)


def perturbed(policy, seed):
    """The policy with other weights, so that nothing is zero or balanced as at the start."""
    torch.manual_seed(seed)
    with torch.no_grad():
        for parameter in policy.parameters():
            parameter.add_(0.2 * torch.randn_like(parameter))
    return policy


def frames(dataset, indices, *others):
    """A batch as LeRobot's loader and processors hand it to the policy."""
    items = [dataset[i] for i in indices]
    kept = ("observation.instances", "action", "episode_index", "index", *others)
    return {key: torch.stack([item[key] for item in items]) for key in kept}


def observations(sessions, decision=0):
    """What environments show at a decision of the expert, one row of the batch a session."""
    sessions = [make_session("val", session) for session in sessions]
    sets = np.stack([demonstrate(session).instances[decision] for session in sessions])
    prompts = np.stack([prompt_of(prompt_session(session)) for session in sessions])
    return {
        "observation.instances": torch.from_numpy(sets),
        "observation.prompt": torch.from_numpy(prompts),
    }


def spied(policy):
    """The policy, and a list of the situations that its network will be shown."""
    shown, decide = [], policy.network.decide

    def spy(situations, *others):
        shown.append(situations)
        return decide(situations, *others)

    policy.network.decide = spy
    return policy, shown


def scores_of(policy, batch):
    """The network's scores, (B, N), where every other row has failed before."""
    sets = batch["observation.instances"]
    failed = choosable(sets) & (torch.arange(sets.shape[1]) % 2 == 0)
    tokens = tokens_of_prompts(batch["observation.prompt"], policy.config.prompt_tokens)
    preference = policy.network.encode(*tokens)
    situations = Situations(sets, failed, sets[:, :0])
    return policy.network.decide(situations, preference, torch.arange(len(sets)))

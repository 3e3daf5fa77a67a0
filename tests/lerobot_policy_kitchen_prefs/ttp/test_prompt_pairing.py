"""Prompt-situation pairs: prompts are other sessions of the same preference."""

import numpy as np
import torch
from tiny_ttp import COMPACT, frames, make_policy

from kitchen_prefs.instances import IS_PLACE, is_real


def test_each_situation_goes_with_a_prompt_of_its_preference(pairs, demonstrations, sessions):
    of_prompt = [
        next(
            label
            for episode, label in enumerate(demonstrations.preference)
            if torch.equal(prompt, torch.from_numpy(demonstrations.prompts([episode])[0]))
        )
        for prompt in map(_trimmed, pairs.prompts)
    ]
    assert {of_prompt[g] for g in pairs.prompt_of.tolist()} == {sessions[0].label}
    is_place = (pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    assert (pairs.prompt_of[is_place] == 0).all()
    assert pairs.prompt_of[~is_place].bincount().unique().numel() == 1


def _trimmed(prompt):
    return prompt[: int(is_real(prompt).sum())]


def test_prompts_are_other_sessions_of_the_same_preference(dataset):
    demonstrations = make_policy(dataset, **COMPACT).demonstrations
    generator = np.random.default_rng(0)
    labels = demonstrations.preference
    for episode, label in enumerate(labels):
        drawn = {demonstrations.draw(label, np.array([episode]), generator) for _ in range(40)}
        assert drawn == set(np.flatnonzero(labels == label)) - {episode}


def test_an_episode_without_others_prompts_itself(dataset):
    demonstrations = make_policy(dataset, **COMPACT).demonstrations
    mine = np.flatnonzero(demonstrations.preference == demonstrations.preference[0])
    assert demonstrations.draw(demonstrations.preference[0], mine, np.random.default_rng(0)) in mine


def test_labels_pair_and_never_reach_the_network(dataset):
    batch = frames(dataset, (3, 50, 120, 160))
    policy, renamed = make_policy(dataset, **COMPACT), make_policy(dataset, **COMPACT)
    renamed.demonstrations.preference = renamed.demonstrations.preference + 100
    assert torch.equal(policy.eval()(batch)[0], renamed.eval()(batch)[0])
    batch["preference"] = torch.tensor([9, 9, 9, 9])
    assert torch.equal(policy(batch)[0], renamed(batch)[0])

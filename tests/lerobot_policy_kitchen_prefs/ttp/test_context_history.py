"""Context history: training and rollout see the same earlier objects."""

import torch
from lerobot.datasets import LeRobotDataset
from tiny_ttp import frames, make_policy, observations, spied

from kitchen_prefs.instances import DECISION, is_real


def test_the_history_is_the_same_in_training_and_in_acting(dataset):
    key, length = "observation.instances", 6
    seconds = {key: [-2 / dataset.fps, -1 / dataset.fps, 0.0]}
    with_past = LeRobotDataset(dataset.repo_id, root=dataset.root, delta_timestamps=seconds)
    policy, shown = spied(make_policy(dataset, context_history=2).eval())
    for frame in range(length):
        policy(frames(with_past, [frame], f"{key}_is_pad"))
    for frame in range(length):
        prompt = observations([0])["observation.prompt"]
        policy.select_action({key: dataset[frame][key][None], "observation.prompt": prompt})
    histories = [situations.history[is_real(situations.history)] for situations in shown]
    for frame in range(length):
        in_training, in_acting = histories[frame], histories[length + frame]
        assert torch.equal(in_training, in_acting)
        assert set(in_acting[:, DECISION].tolist()) == set(range(max(0, frame - 2), frame))

"""Relabelling as a processor step: prompt, set and action together, and the environment's never."""

import torch
from lerobot.processor import PolicyProcessorPipeline
from lerobot.processor.converters import batch_to_transition, transition_to_batch

from kitchen_prefs.datasets.prompt_step import PromptStep
from kitchen_prefs.instances import EXTENTS, is_place_decision, is_real
from lerobot_policy_kitchen_prefs.common.instance_sets import chosen_rows
from lerobot_policy_kitchen_prefs.common.relabelling_step import RelabellingStep


def batches(dataset, seed=0):
    """A batch with prompts before and after relabelling, the sets as rows."""
    batch = torch.utils.data.default_collate([dataset[i] for i in range(0, dataset.num_frames, 3)])
    steps = [
        PromptStep(dataset.repo_id, str(dataset.root)),
        RelabellingStep(dataset.repo_id, str(dataset.root), seed),
    ]
    for used in (steps[:1], steps):
        pipeline = PolicyProcessorPipeline(
            steps=used, to_transition=batch_to_transition, to_output=transition_to_batch
        )
        yield pipeline(batch)


def rows_of(batch):
    sets = batch["observation.instances"]
    return sets.reshape(len(sets), -1, 13)


def test_sample_by_sample_one_permutation_holds_for_prompt_and_set(dataset):
    before, after = batches(dataset)
    permuted = 0
    picks = ~is_place_decision(rows_of(before))
    for b in picks.nonzero()[:, 0].tolist():
        mapping = {}
        for key in (rows_of, lambda batch: batch["observation.prompt"]):
            old, new = key(before)[b], key(after)[b]
            assert torch.equal(is_real(old), is_real(new))
            for o, n in zip(old[:, EXTENTS].tolist(), new[:, EXTENTS].tolist(), strict=True):
                assert mapping.setdefault(tuple(o), tuple(n)) == tuple(n)
        assert len(set(mapping.values())) == len(mapping)
        permuted += any(old != new for old, new in mapping.items())
    assert permuted > len(before["index"]) / 4


def test_actions_are_the_poses_of_the_same_rows(dataset):
    before, after = batches(dataset)
    assert torch.equal(
        chosen_rows(rows_of(before), before["action"]), chosen_rows(rows_of(after), after["action"])
    )
    assert not torch.equal(before["action"], after["action"])
    assert after["observation.instances"].shape == before["observation.instances"].shape


def test_place_decisions_keep_their_sets(dataset):
    before, after = batches(dataset)
    is_place = is_place_decision(rows_of(before))
    assert torch.equal(rows_of(before)[is_place], rows_of(after)[is_place])


def test_the_seed_decides(dataset):
    (_, first), (_, again), (_, other) = (batches(dataset, seed) for seed in (0, 0, 1))
    assert torch.equal(first["observation.prompt"], again["observation.prompt"])
    assert not torch.equal(first["observation.prompt"], other["observation.prompt"])


def test_the_environments_observations_pass_unchanged(dataset):
    observation = {"observation.prompt": torch.rand(1, 1664, 14)}
    step = RelabellingStep(dataset.repo_id, str(dataset.root))
    transition = batch_to_transition(observation)
    assert step(transition) is transition

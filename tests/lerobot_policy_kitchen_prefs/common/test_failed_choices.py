"""Failed choices: found again while nothing has changed, forgotten after a success, synthesised."""

import gymnasium
import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from kitchen_prefs import instances
from kitchen_prefs.envs.demonstrations import demonstrate
from kitchen_prefs.instances import IS_OBJECT, IS_PLACE, POSE, POSITION, choosable
from kitchen_prefs.simulation.sessions import make_session
from lerobot_policy_kitchen_prefs.common.failed_choices import FailedChoices, synthesise_failures

SEEDS = st.integers(0, 10_000)
DECISIONS = 60


class RandomRollout:
    """One environment, rolled out by the expert and at random in turn."""

    def __init__(self, session):
        self.environment = gymnasium.make(
            "kitchen_prefs/DishwasherLoading-v0", split="seen"
        ).unwrapped
        self.set = self.environment.reset(seed=session)[0]["instances"]
        self.generator = np.random.default_rng(session)
        self.failed = set()  # instances, by what the environment says
        self.refusals = 0

    def choose(self):
        """Choose a row, right or wrong, and give it back, (13,)."""
        rows = np.flatnonzero(instances.choosable(self.set))
        row = self.generator.choice(rows)
        if self.generator.random() < 0.3:
            expert = self.environment.simulator.expert_action()
            row = rows[(self.set[rows, POSE] == expert).all(axis=1)][0]
        choice = self.set[row]
        instance = self.environment.simulator.choose(choice[POSE])[0]
        observation, _, _, _, info = self.environment.step(choice[POSE])
        self.set = observation["instances"]
        self.failed = self.failed | {instance} if info["refusal"] else set()
        self.refusals += bool(info["refusal"])
        return choice

    def instances(self, marks):
        return {self.environment.simulator.choose(row[POSE])[0] for row in self.set[marks]}


def test_what_the_kitchen_refused_is_marked_until_something_succeeds():
    rollouts = [RandomRollout(session) for session in range(3)]
    failures = FailedChoices()
    for _ in range(DECISIONS):
        sets = torch.from_numpy(np.stack([rollout.set for rollout in rollouts]))
        marks = failures.find(sets).numpy()
        for rollout, marked in zip(rollouts, marks, strict=True):
            assert rollout.instances(marked) == rollout.failed
        choices = np.stack([rollout.choose() for rollout in rollouts])
        failures.record(torch.from_numpy(choices))
    for rollout in rollouts:
        assert 5 < rollout.refusals < DECISIONS - 5


def first_sets():
    """What four sessions show before their first decision, (4, N, 13)."""
    sessions = [make_session("val", index) for index in range(4)]
    return torch.from_numpy(np.stack([demonstrate(session).instances[0] for session in sessions]))


def observed_again(sets, generator):
    """The same sets, with dishes up to 1 cm elsewhere and rows in another order; and the order."""
    errors = torch.from_numpy(generator.uniform(-0.01, 0.01, (*sets.shape[:2], 3))).float()
    again = sets.clone()
    again[..., POSITION] += errors * (sets[..., IS_OBJECT, None] > 0)
    order = torch.from_numpy(generator.permutation(sets.shape[1]))
    return again[:, order], order


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS)
def test_a_failure_is_found_again_under_noise(seed):
    generator = np.random.default_rng(seed)
    sets, failures, failed = first_sets(), FailedChoices(), []
    for _ in range(3):
        seen, order = observed_again(sets, generator)
        marks = failures.find(seen)
        expected = torch.zeros_like(marks)
        for rows in failed:
            expected |= order == rows[:, None]
        assert torch.equal(marks, expected)
        rows = torch.tensor([generator.choice(may.nonzero()[:, 0]) for may in choosable(sets)])
        failed.append(rows)
        failures.record(seen[torch.arange(4), order.argsort()[rows]])


def test_nothing_has_failed_before_the_first_choice():
    assert not FailedChoices().find(first_sets()).any()


def test_a_success_in_one_episode_leaves_the_failures_of_the_others():
    sets = first_sets()
    rows = (sets[..., IS_OBJECT] > 0).int().argmax(dim=1)
    failures = FailedChoices()
    failures.record(sets[torch.arange(4), rows])
    sets[2, rows[2]] = 0  # the dish was picked, the rack moved
    assert failures.find(sets).sum(dim=1).tolist() == [1, 1, 0, 1]


@settings(max_examples=30, deadline=None)
@given(seed=SEEDS)
def test_synthesised_failures_are_choices_that_may_have_failed(pairs, categories, seed):
    marks = synthesise_failures(pairs.sets, pairs.targets, np.random.default_rng(seed))
    assert not (marks & ~choosable(pairs.sets)).any()
    situations = torch.arange(len(pairs.sets))
    target = pairs.sets[situations, pairs.targets]
    target_failed = marks[situations, pairs.targets]
    assert not target[target_failed, IS_PLACE].any()
    assert categories.find(target[target_failed])[1].all()


def test_synthesised_failures_leave_some_situations_alone_and_spare_no_kind(pairs, categories):
    generator = np.random.default_rng(0)
    marks = torch.stack(
        [synthesise_failures(pairs.sets, pairs.targets, generator) for _ in range(40)]
    )
    situations = torch.arange(len(pairs.sets))
    is_place = (pairs.sets[..., IS_PLACE] > 0).any(dim=1)
    assert (~marks.any(dim=-1)).float().mean() > 0.4
    assert marks[:, is_place].any()
    slipped = marks[:, situations, pairs.targets].float().mean(dim=0)  # (S,)
    is_dish = categories.find(pairs.sets[situations, pairs.targets])[1]
    assert float(slipped[is_dish & ~is_place].mean()) == pytest.approx(0.05, abs=0.02)

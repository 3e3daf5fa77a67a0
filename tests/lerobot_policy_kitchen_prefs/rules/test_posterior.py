"""The posterior over all preferences: what a prompt and a session's dishes leave open."""

import numpy as np
import pytest

from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.evaluation.policy_loading import load_policy
from kitchen_prefs.evaluation.rollouts import roll_out
from kitchen_prefs.metrics import packing_efficiency, score
from kitchen_prefs.preferences import preference_from_number, preference_number
from kitchen_prefs.simulation.expert import choose
from kitchen_prefs.simulation.sessions import make_session
from lerobot_policy_kitchen_prefs.rules.observed_view import Memory, ObservedView
from lerobot_policy_kitchen_prefs.rules.posterior import prompt_likelihood, session_likelihood
from lerobot_policy_kitchen_prefs.rules.preference_inference import decisions_of
from lerobot_policy_kitchen_prefs.rules.preference_space import expert_choices, preference_space


@pytest.mark.parametrize("index", range(0, 200, 40))
def test_every_preference_at_once_chooses_as_one_alone(index):
    memory = Memory()
    for rows, _ in decisions_of(prompt_of(make_session("prompts", 400 + index))):
        view = ObservedView(rows, memory)
        chosen = expert_choices(view)
        for number in range(index, 10_080, 997):
            assert chosen[number] == choose(view, preference_from_number(number))


@pytest.mark.parametrize("index", range(0, 400, 80))
def test_the_preference_of_a_prompt_explains_it_and_few_others_do(index):
    session = make_session("prompts", index)
    likelihood = prompt_likelihood(prompt_of(session))
    assert likelihood[preference_number(session.preference)] == 1
    assert 1 <= likelihood.sum() <= 48


def test_no_partition_makes_three_dishes_of_a_rack_three_of_a_category():
    assert not session_likelihood((3, 0, 0, 0, 0, 0, 0), 3).any()


@pytest.mark.parametrize("index", range(0, 150, 25))
def test_the_preference_of_a_session_is_always_possible(index):
    session = make_session("unseen_both", index)
    partition = preference_space().partition[preference_number(session.preference)]
    for so_far in range(session.dishes.present, len(session.dishes.category) + 1):
        dishes = np.bincount(session.dishes.category[:so_far], minlength=7)
        assert session_likelihood(tuple(dishes.tolist()), session.dishes.present)[partition] > 0


def decisions(rule, sessions, **options):
    """The decisions of a rule in sessions of unseen_preferences, by session."""
    policy = load_policy(policy_type="rules", options=[f"--rule={rule}"])
    episodes = roll_out(policy, "unseen_preferences", sessions=sessions, **options)
    return {episode.session: episode.decisions for episode in episodes}


@pytest.mark.parametrize("rule", ["promptless", "bayes"])
def test_the_other_episodes_of_a_batch_change_nothing(rule):
    together = decisions(rule, [0, 25, 50])
    assert decisions(rule, [50, 99, 0]).items() >= {0: together[0], 50: together[50]}.items()
    assert decisions(rule, [25], batch_size=1)[25] == together[25]


def test_the_floor_reads_no_prompt_and_the_ceiling_does():
    sessions = range(0, 100, 25)
    for rule, ignores_it in (("promptless", True), ("bayes", False)):
        same, other = (decisions(rule, sessions, prompt_of=whose) for whose in ("same", "other"))
        assert (same == other) == ignores_it


def test_the_floor_lies_in_the_middle_and_the_ceiling_near_the_top():
    mean = {}
    for rule in ("promptless", "bayes"):
        policy = load_policy(policy_type="rules", options=[f"--rule={rule}"])
        episodes = roll_out(policy, "unseen_preferences", sessions=range(0, 100, 10))
        mean[rule] = [
            np.mean([metric(e) for e in episodes]) for metric in (packing_efficiency, score)
        ]
    assert mean["promptless"] == pytest.approx([0.66, 0.57], abs=0.08)
    assert mean["bayes"] == pytest.approx([1, 0.985], abs=0.015)

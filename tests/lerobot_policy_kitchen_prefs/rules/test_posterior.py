"""The posterior over all preferences: what a prompt and a session's dishes leave open."""

import numpy as np
import pytest

from kitchen_prefs.envs.demonstrations import prompt_of
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

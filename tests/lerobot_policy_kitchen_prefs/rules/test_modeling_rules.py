"""The rules: floor, references and ceiling, through the public policy and environment."""

import numpy as np
import pytest
import torch
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from lerobot.envs import make_env_pre_post_processors, preprocess_observation
from lerobot.envs.utils import env_to_policy_features, freeze_after_episode_end
from lerobot.policies import make_pre_post_processors
from lerobot.scripts.lerobot_eval import eval_policy

from kitchen_prefs.envs.demonstrations import prompt_of
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.lerobot_env import FEATURES_MAP, KitchenPrefsEnv
from kitchen_prefs.metrics import edit_similarity, packing_efficiency, score
from kitchen_prefs.preferences import HELD_OUT, SEEN
from kitchen_prefs.simulation.sessions import make_session
from lerobot_policy_kitchen_prefs.rules.configuration_rules import RulesConfig
from lerobot_policy_kitchen_prefs.rules.modeling_rules import RulesPolicy
from lerobot_policy_kitchen_prefs.rules.preference_inference import (
    nearest_training_preference,
    symbolic_preference,
)


def make_rule(rule, env_config):
    features = env_to_policy_features(env_config)
    action = features.pop(FEATURES_MAP["action"])
    return RulesPolicy(
        RulesConfig(rule=rule, input_features=features, output_features={"action": action})
    )


def roll_out(rule, split, sessions, track="standard"):
    """The episodes of a rule on some sessions, rolled out as one batch."""
    config = KitchenPrefsEnv(task=split, track=track)
    policy = make_rule(rule, config)
    envs = [DishwasherLoading(split, track) for _ in sessions]
    ones = [freeze_after_episode_end(lambda env=env: env) for env in envs]
    batch = SyncVectorEnv(ones, autoreset_mode=AutoresetMode.SAME_STEP)
    observation, _ = batch.reset(seed=list(sessions))
    done = np.zeros(len(sessions), dtype=bool)
    while not done.all():
        action = policy.select_action(preprocess_observation(observation))
        observation, _, terminated, truncated, _ = batch.step(action.numpy())
        done |= terminated | truncated
    return [env.episode() for env in envs]


def mean(metric, episodes):
    return float(np.mean([metric(episode) for episode in episodes]))


@pytest.mark.parametrize("split", ["seen", "unseen_counts", "many_preferences"])
def test_the_expert_is_perfect(split):
    episodes = roll_out("expert", split, range(0, 70, 5), track="privileged")
    assert mean(packing_efficiency, episodes) == mean(edit_similarity, episodes) == 1


def test_the_order_of_the_rules_on_held_out_preferences():
    scores = {
        rule: mean(score, roll_out(rule, "unseen_preferences", range(0, 100, 7)))
        for rule in ("random", "majority", "nearest", "symbolic")
    }
    assert scores["random"] < scores["majority"] < scores["nearest"] < scores["symbolic"]
    assert scores["symbolic"] > 0.9
    assert scores["nearest"] < 0.8


def test_symbolic_reads_the_racks_of_every_complete_prompt():
    for preference_index, preference in enumerate(HELD_OUT):
        for i in range(0, 80, 8):
            session = make_session("prompts", 80 * preference_index + i)
            read = symbolic_preference(prompt_of(session))
            assert read.first == preference.first
            assert set(read.top) == set(preference.top)


def test_nearest_finds_a_training_preference():
    for i in range(0, 560, 40):
        session = make_session("train", i)
        assert nearest_training_preference(prompt_of(session)) == session.preference
    held_out = make_session("prompts", 0)
    assert nearest_training_preference(prompt_of(held_out)) in SEEN


def test_a_rule_does_not_depend_on_the_batch():
    together = roll_out("random", "seen", range(3))
    alone = [roll_out("random", "seen", [i])[0] for i in range(3)]
    assert [episode.decisions for episode in together] == [episode.decisions for episode in alone]


def evaluate_as_lerobot_does(rule, batch_size):
    """The reward and the success of 16 sessions, by seed, as `lerobot-eval` finds them."""
    config = KitchenPrefsEnv(task="unseen_both")
    policy = make_rule(rule, config)
    environment_steps = make_env_pre_post_processors(config, policy.config)
    policy_steps = make_pre_post_processors(policy.config)
    batch = config.create_envs(batch_size)["kitchen_prefs"][8]
    results = eval_policy(
        batch, policy, *environment_steps, *policy_steps, n_episodes=16, start_seed=1000
    )
    return {
        episode["seed"]: (episode["sum_reward"], episode["success"])
        for episode in results["per_episode"]
    }


@pytest.mark.lerobot
@pytest.mark.parametrize("rule", ["random", "symbolic"])
def test_lerobot_eval_finds_the_same_for_each_session_at_any_batch_size(rule):
    one, seven, sixteen = (evaluate_as_lerobot_does(rule, size) for size in (1, 7, 16))
    assert list(one) == list(range(1000, 1016))
    assert one == seven == sixteen
    assert len(set(one.values())) > 4


def test_rules_take_sums_of_nothing():
    policy = make_rule("random", KitchenPrefsEnv())
    assert sum(parameter.numel() for parameter in policy.parameters()) == 0
    with pytest.raises(ValueError, match="not trained"):
        policy.forward({"action": torch.zeros(1, 7)})


def test_an_unknown_rule_suggests_the_nearest():
    with pytest.raises(ValueError, match="Did you mean 'expert'"):
        RulesConfig(rule="expret")


def test_the_expert_asks_for_the_privileged_track():
    with pytest.raises(ValueError, match=r"env\.track=privileged"):
        make_rule("expert", KitchenPrefsEnv())

"""TTP with a plan through LeRobot's public entries: training, acting, checkpoints."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from lerobot.configs import FeatureType, PolicyFeature

from kitchen_prefs.envs.people_environment import DishwasherPeople
from kitchen_prefs.instances import (
    CAPACITY,
    COLUMNS,
    PEOPLE_PROMPT_CAPACITY,
    POSE,
    choosable,
    is_real,
)
from lerobot_policy_kitchen_prefs.ttp_plan import PlanTTPConfig, PlanTTPPolicy
from lerobot_policy_kitchen_prefs.ttp_plan.augmentation import Augmentation

RNG, CPU = np.random.default_rng(0), torch.device("cpu")
KEYS = ("observation.instances", "action", "episode_index", "index")


def frames(dataset, indices):
    items = [dataset[i] for i in indices]
    return {key: torch.stack([item[key] for item in items]) for key in KEYS}


def observed(sessions, split="people_train", decisions=0):
    """What environments show after some decisions of the expert, one row a session."""
    shown = []
    for session in sessions:
        environment = DishwasherPeople(split)
        observation, _ = environment.reset(options={"session": session})
        for _ in range(decisions):
            observation, *_ = environment.step(environment.simulator.expert_action())
        shown.append(observation)
    return batch_of(shown)


def batch_of(shown):
    names = {"instances": "instances", "prompt": "prompt", "agent_pos": "state"}
    return {
        f"observation.{name}": torch.from_numpy(np.stack([one[key] for one in shown]))
        for key, name in names.items()
    }


def test_training_learns_the_expert_s_choices(people_dataset, make_policy):
    policy = make_policy(people_dataset).train()
    optimizer = torch.optim.Adam(policy.get_optim_params(), lr=3e-3)
    losses = []
    for _ in range(30):
        loss, shares = policy(frames(people_dataset, range(0, 160, 10)))
        loss.backward()
        optimizer.step()
        optimizer.zero_grad()
        losses.append(loss.item())
    assert np.mean(losses[-5:]) < 0.8 * np.mean(losses[:3])
    assert set(shares) == {"pick_accuracy", "place_accuracy", "zone_accuracy", "order_accuracy"}


def test_every_parameter_is_trained(people_dataset, make_policy):
    policy = make_policy(people_dataset).train()
    loss, _ = policy(frames(people_dataset, range(0, 160, 5)))
    loss.backward()
    idle = [n for n, p in policy.named_parameters() if p.grad is None or not p.grad.any()]
    assert not idle


def test_the_loss_of_evaluation_depends_on_the_batch_alone(people_dataset, make_policy):
    policy, batch = make_policy(people_dataset).eval(), frames(people_dataset, range(0, 160, 9))
    assert policy(batch)[0] == policy(batch)[0]


@pytest.mark.parametrize("decisions", [0, 1, 3])
def test_an_action_is_the_pose_of_a_row_that_may_be_chosen(make_policy, decisions):
    batch = observed(range(3), decisions=decisions)
    actions = make_policy().select_action(batch)
    sets = batch["observation.instances"]
    chosen = (sets[..., POSE] == actions[:, None]).all(dim=-1) & choosable(sets)
    assert chosen.any(dim=1).all()


def test_an_episode_does_not_depend_on_the_others_of_its_batch(make_policy):
    policy, batch = make_policy(), observed(range(4), decisions=3)
    together = policy.select_action(batch)
    for i in range(4):
        policy.reset()
        alone = policy.select_action({key: value[i : i + 1] for key, value in batch.items()})
        assert torch.equal(alone[0], together[i])


def test_the_order_of_rows_does_not_matter(make_policy):
    policy, batch = make_policy(), observed(range(3), decisions=3)
    chosen = policy.select_action(batch)
    policy.reset()
    sets = batch["observation.instances"]
    turned = torch.zeros_like(sets)
    for mine, shown in zip(turned, sets, strict=True):
        rows = shown[is_real(shown)]
        mine[: len(rows)] = rows.flip(0)
    assert torch.allclose(policy.select_action({**batch, "observation.instances": turned}), chosen)


def test_only_the_prompt_of_whose_evening_it_is_is_read(make_policy):
    policy, one = make_policy(), observed([0])
    other = observed([2])
    first = {
        **one,
        "observation.prompt": torch.cat(
            [one["observation.prompt"], other["observation.prompt"]], dim=1
        ),
    }
    assert first["observation.prompt"].shape[1] == 2 * PEOPLE_PROMPT_CAPACITY
    second = {
        "observation.instances": one["observation.instances"],
        "observation.prompt": first["observation.prompt"].roll(PEOPLE_PROMPT_CAPACITY, dims=1),
        "observation.state": one["observation.state"].clone(),
    }
    second["observation.state"][:, -1] = 1
    actions = []
    for batch in (one, first, second):
        policy.reset()
        actions.append(policy.select_action(batch))
    assert torch.equal(actions[0], actions[1])
    assert torch.equal(actions[0], actions[2])


def test_a_checkpoint_acts_as_the_policy_did(make_policy, tmp_path):
    policy, batch = make_policy(), observed(range(2), decisions=1)
    policy.save_pretrained(tmp_path)
    again = PlanTTPPolicy.from_pretrained(tmp_path)
    assert torch.equal(again.select_action(batch), policy.select_action(batch))


def test_without_a_data_set_it_says_that_it_cannot_train(people_dataset, make_policy):
    with pytest.raises(ValueError, match="prompts from the training data set"):
        make_policy()(frames(people_dataset, range(2)))


def test_an_episode_that_alone_has_its_user_cannot_be_prompted(people_dataset, make_policy):
    policy = make_policy(people_dataset)
    policy.demonstrations.preference = np.arange(4)
    with pytest.raises(ValueError, match="only one of its user"):
        policy(frames(people_dataset, range(2)))


@pytest.mark.parametrize("count", [1, 3])
def test_it_acts_to_the_end_of_every_episode(make_policy, count):
    policy = make_policy()
    environments = [DishwasherPeople("people_train") for _ in range(count)]
    shown = [one.reset(options={"session": i})[0] for i, one in enumerate(environments)]
    while not all(one.simulator.terminated for one in environments):
        policy.select_action(batch_of(shown))
        for i, environment in enumerate(environments):
            if not environment.simulator.terminated:
                shown[i], *_ = environment.step(environment.simulator.expert_action())


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [({"clashes": False}, "clashes is always True"), ({"rounds": 2}, "rounds is always 1")],
)
def test_what_it_cannot_be_without_is_said(make_policy, settings, sentence):
    with pytest.raises(ValueError, match=sentence):
        make_policy(**settings)


def test_the_first_tier_is_refused_in_a_sentence():
    shape = (CAPACITY, COLUMNS)
    config = PlanTTPConfig(
        input_features={"observation.instances": PolicyFeature(FeatureType.STATE, shape)},
        output_features={"action": PolicyFeature(FeatureType.ACTION, (7,))},
    )
    with pytest.raises(ValueError, match="reads colours and materials"):
        config.validate_features()


def test_what_is_shown_of_an_own_episode_tells_nothing_of_the_rest(people_dataset, make_policy):
    policy = make_policy(people_dataset).train()
    own = policy._placed.select(torch.arange(4))
    augmentation = Augmentation(4, replace(policy.config, decided=0, own_share=1.0), RNG, CPU)
    shown, asked = augmentation.split(own)
    assert shown.mask.any()
    assert not (shown.mask & asked.mask).any()
    before = shown.mask.cumsum(dim=1) - shown.mask.int()
    assert (shown.contents.sum((-1, -2)) <= before).all()

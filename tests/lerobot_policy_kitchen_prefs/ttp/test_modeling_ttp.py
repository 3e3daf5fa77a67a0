"""TTP through LeRobot's public entries: training on a small data set, acting, checkpoints."""

import pytest
import torch
from tiny_ttp import (
    BOTH,
    COMPACT,
    FINAL,
    OTHER_ENCODINGS,
    PAPER,
    frames,
    make_policy,
    observations,
    perturbed,
    spied,
)

from kitchen_prefs.instances import CHOSEN, IS_OBJECT, IS_PLACE, POSE
from lerobot_policy_kitchen_prefs.ttp import TTPPolicy


@BOTH
def test_training_learns_the_expert_s_choices(dataset, settings):
    policy = make_policy(dataset, **settings)
    policy.train()
    optimizer = torch.optim.Adam(policy.get_optim_params(), lr=3e-3)
    batch = frames(dataset, range(0, 60, 4))
    losses = []
    for _ in range(30):
        loss, _ = policy(batch)
        loss.backward()
        optimizer.step()
        optimizer.zero_grad()
        losses.append(loss.item())
    assert losses[-1] < 0.7 * losses[0]


@pytest.mark.parametrize(
    "settings",
    [PAPER, COMPACT, FINAL, OTHER_ENCODINGS],
    ids=["paper", "compact", "final", "other encodings"],
)
def test_every_parameter_is_trained(dataset, settings):
    policy = make_policy(dataset, **settings)
    loss, _ = policy.train()(frames(dataset, range(0, 200, 9)))
    loss.backward()
    idle = [n for n, p in policy.named_parameters() if p.grad is None or not p.grad.any()]
    assert not idle


@BOTH
def test_the_accuracies_of_picks_and_places_are_shares(dataset, settings):
    policy = make_policy(dataset, **settings)
    _, accuracies = policy(frames(dataset, range(0, 200, 9)))
    assert list(accuracies) == ["pick_accuracy", "place_accuracy"]
    assert all(0 <= accuracy < 1 for accuracy in accuracies.values())


@BOTH
def test_the_loss_depends_on_the_batch_alone(dataset, settings):
    batch = frames(dataset, (3, 50, 120))
    first, again = (make_policy(dataset, **settings).train()(batch)[0] for _ in range(2))
    assert torch.equal(first, again)


@BOTH
@pytest.mark.parametrize("decision", [0, 3])
def test_an_action_is_the_pose_of_a_row_that_can_be_chosen(settings, decision):
    batch = observations(range(6), decision)
    actions = make_policy(**settings).select_action(batch)
    for rows, action in zip(batch["observation.instances"], actions, strict=True):
        kind = IS_PLACE if rows[:, IS_PLACE].any() else IS_OBJECT
        poses = rows[rows[:, kind] > 0][:, POSE]
        assert (poses == action).all(dim=1).any()


@BOTH
def test_what_is_chosen_depends_neither_on_row_order_nor_on_the_batch(settings):
    batch = observations(range(4), 3)
    policy = make_policy(**settings)
    actions = policy.select_action(batch)
    for session in range(4):
        rows = batch["observation.instances"][session]
        real = int((rows[:, IS_OBJECT] + rows[:, IS_PLACE] > 0).sum())
        shuffled = torch.cat([rows[:real].flip(0), rows[real:]])
        policy.reset()
        alone = {
            "observation.instances": shuffled[None],
            "observation.prompt": batch["observation.prompt"][session, None],
        }
        assert torch.equal(policy.select_action(alone)[0], actions[session])


def test_the_prompt_is_read_once_an_episode():
    batch = observations([0, 1], 3)
    policy = make_policy(**COMPACT | {"failures": False})
    first = policy.select_action(batch)
    del batch["observation.prompt"]
    assert torch.equal(policy.select_action(batch), first)
    policy.reset()
    with pytest.raises(ValueError, match=r"observation\.prompt"):
        policy.select_action(batch)


def test_the_paper_s_prompt_leaves_the_chosen_rows_out():
    batch = observations([0, 1, 2], 3)
    policy = make_policy(**PAPER)
    actions = policy.select_action(batch)
    batch["observation.prompt"][..., CHOSEN] = 0
    policy.reset()
    assert torch.equal(policy.select_action(batch), actions)


def test_the_first_decision_of_an_episode_has_no_failures():
    policy, shown = spied(make_policy(**COMPACT))
    batch = observations(range(4))
    for _ in range(2):
        policy.select_action(batch)
        policy.select_action(batch)
        policy.reset()
    assert [int(situations.failed.sum()) for situations in shown] == [0, 4, 0, 4]


def test_failed_choices_are_marked():
    policy, shown = spied(make_policy(**COMPACT))
    batch = observations(range(4))
    actions = policy.select_action(batch)
    policy.select_action(batch)
    assert torch.equal(shown[1].sets[shown[1].failed][:, POSE], actions)


def with_prompts_of(batch, order):
    """The batch, each prompted with several demonstrations, one below the other."""
    prompts = torch.cat([batch["observation.prompt"][others] for others in order], dim=1)
    return batch | {"observation.prompt": prompts}


@BOTH
def test_the_order_of_several_prompts_does_not_matter(settings):
    batch = observations(range(4), 3)
    actions = []
    for order in (([0, 1, 2, 3], [1, 2, 3, 0]), ([1, 2, 3, 0], [0, 1, 2, 3])):
        actions.append(make_policy(**settings).select_action(with_prompts_of(batch, order)))
    assert torch.equal(*actions)


@BOTH
def test_the_same_prompt_twice_says_what_it_says_once(settings):
    batch = observations(range(4), 3)
    twice = with_prompts_of(batch, ([0, 1, 2, 3], [0, 1, 2, 3]))
    once, again = (make_policy(**settings).select_action(b) for b in (batch, twice))
    assert torch.equal(once, again)


@BOTH
def test_a_checkpoint_acts_like_the_policy_that_saved_it(tmp_path, settings):
    policy = perturbed(make_policy(**settings), seed=0)
    policy.save_pretrained(tmp_path)
    batch = observations(range(5), 3)
    loaded = TTPPolicy.from_pretrained(tmp_path)
    assert torch.equal(loaded.select_action(batch), policy.select_action(batch))


def test_training_without_a_data_set_says_what_is_missing(dataset):
    with pytest.raises(ValueError, match="dataset_meta"):
        make_policy()(frames(dataset, [0]))


def test_an_action_that_is_no_row_is_refused(dataset):
    batch = frames(dataset, [0, 1])
    batch["action"] = batch["action"] + 1e-3
    with pytest.raises(ValueError, match="pose of any row"):
        make_policy(dataset)(batch)

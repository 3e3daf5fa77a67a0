"""TTP through LeRobot's public entries: training on a small data set, acting, checkpoints."""

import numpy as np
import pytest
import torch
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.datasets import LeRobotDataset

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.demonstrations import demonstrate, prompt_of
from kitchen_prefs.instances import CAPACITY, CHOSEN, COLUMNS, IS_OBJECT, IS_PLACE, POSE
from kitchen_prefs.sessions import make_session, prompt_session
from lerobot_policy_kitchen_prefs.ttp import TTPConfig, TTPPolicy

NAME = "dishwasher-train-p2-d3-v1"  # two preferences, three demonstrations each
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
# All that departs from the paper, as in the recipe ttp_quick.
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
    "avoid_repeats": True,
}
BOTH = pytest.mark.parametrize("settings", [PAPER, COMPACT], ids=["paper", "compact"])


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(tmp_path_factory.mktemp("home")))
        root = make_dataset(NAME)
    return LeRobotDataset(f"kitchen_prefs/{NAME}", root=root)


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


def frames(dataset, indices):
    """A batch as LeRobot's loader and processors hand it to the policy."""
    items = [dataset[i] for i in indices]
    kept = ("observation.instances", "action", "episode_index", "index")
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


@BOTH
def test_every_parameter_is_trained(dataset, settings):
    policy = make_policy(dataset, **settings)
    loss, _ = policy.train()(frames(dataset, range(0, 200, 9)))
    loss.backward()
    idle = [n for n, p in policy.named_parameters() if p.grad is None or not p.grad.any()]
    assert not idle


@BOTH
def test_the_loss_depends_on_the_batch_alone(dataset, settings):
    batch = frames(dataset, (3, 50, 120))
    first, again = (make_policy(dataset, **settings).train()(batch)[0] for _ in range(2))
    assert torch.equal(first, again)


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
    policy = make_policy(**COMPACT | {"avoid_repeats": False})
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


def test_no_choice_is_made_twice_in_the_same_set():
    batch = observations([0], 0)
    policy = make_policy(**COMPACT)
    rows = batch["observation.instances"][0]
    choices = int((rows[:, IS_OBJECT] > 0).sum())
    actions = []
    for decision in range(choices):
        rows[rows[:, IS_OBJECT] > 0, 10] = decision  # time passes, nothing else changes
        actions.append(tuple(policy.select_action(batch)[0].tolist()))
    assert len(set(actions)) == choices
    assert tuple(policy.select_action(batch)[0].tolist()) == actions[0]


@BOTH
def test_a_checkpoint_acts_like_the_policy_that_saved_it(tmp_path, settings):
    policy = make_policy(**settings)
    with torch.no_grad():
        for parameter in policy.parameters():
            parameter.add_(0.05 * torch.randn_like(parameter))
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


@pytest.mark.parametrize(
    ("inputs", "output"),
    [({}, 7), ({"observation.instances": 12}, 7), ({"observation.instances": 13}, 6)],
)
def test_features_that_do_not_fit_are_named(inputs, output):
    config = TTPConfig(
        device="cpu",
        input_features={
            name: PolicyFeature(FeatureType.STATE, (CAPACITY, n)) for name, n in inputs.items()
        },
        output_features={"action": PolicyFeature(FeatureType.ACTION, (output,))},
    )
    name = "action" if output == 6 else r"observation\.instances"
    with pytest.raises(ValueError, match=name):
        TTPPolicy(config)


@pytest.mark.parametrize(
    "settings", [{"pointer": "rows"}, {"prompt_tokens": "all"}, {"n_heads": 3}, {"rounds": 0}]
)
def test_impossible_settings_are_refused(settings):
    with pytest.raises(ValueError, match=next(iter(settings)).removeprefix("n_")):
        TTPConfig(device="cpu", **settings)

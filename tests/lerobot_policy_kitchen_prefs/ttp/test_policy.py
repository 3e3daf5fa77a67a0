"""TTP through LeRobot's public entries: training on a small data set, acting, checkpoints."""

import numpy as np
import pytest
import torch
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.datasets import LeRobotDataset

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.envs.demonstrations import demonstrate, prompt_of
from kitchen_prefs.instances import (
    CAPACITY,
    CHOSEN,
    COLUMNS,
    DECISION,
    IS_OBJECT,
    IS_PLACE,
    POSE,
    POSITION,
)
from kitchen_prefs.simulation.sessions import make_session, prompt_session
from lerobot_policy_kitchen_prefs.common.instance_sets import choosable, is_real
from lerobot_policy_kitchen_prefs.ttp import TTPConfig, TTPPolicy
from lerobot_policy_kitchen_prefs.ttp.configuration_ttp import ATTRIBUTES
from lerobot_policy_kitchen_prefs.ttp.prompt_tokens import tokens_of_prompts
from lerobot_policy_kitchen_prefs.ttp.situations import Situations

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
# All that departs from the paper, as in the recipe ttp_plus.
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
    "clashes": True,
    "failures": True,
    "recognise": True,
}
FINAL = COMPACT | {"prompt_tokens": "final"}
OTHER_ENCODINGS = {"pose_encoding": "linear", "extents_encoding": "label"}
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


def perturbed(policy, seed):
    """The policy with other weights, so that nothing is zero or balanced as at the start."""
    torch.manual_seed(seed)
    with torch.no_grad():
        for parameter in policy.parameters():
            parameter.add_(0.2 * torch.randn_like(parameter))
    return policy


def frames(dataset, indices, *others):
    """A batch as LeRobot's loader and processors hand it to the policy."""
    items = [dataset[i] for i in indices]
    kept = ("observation.instances", "action", "episode_index", "index", *others)
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


def spied(policy):
    """The policy, and a list of the situations that its network will be shown."""
    shown, decide = [], policy.network.decide

    def spy(situations, *others):
        shown.append(situations)
        return decide(situations, *others)

    policy.network.decide = spy
    return policy, shown


def test_the_first_decision_of_an_episode_has_no_failures():
    policy, shown = spied(make_policy(**COMPACT))
    batch = observations(range(4))
    for _ in range(2):
        policy.select_action(batch)
        policy.select_action(batch)
        policy.reset()
    assert [int(situations.failed.sum()) for situations in shown] == [0, 4, 0, 4]


def test_what_was_chosen_in_vain_is_marked():
    policy, shown = spied(make_policy(**COMPACT))
    batch = observations(range(4))
    actions = policy.select_action(batch)
    policy.select_action(batch)
    assert torch.equal(shown[1].sets[shown[1].failed][:, POSE], actions)


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


def test_a_network_can_learn_to_try_everything_before_it_repeats_itself():
    policy, batch = make_policy(**COMPACT), observations([0])
    choices = int((batch["observation.instances"][0, :, IS_OBJECT] > 0).sum())
    with torch.no_grad():
        policy.network.failures.gate.bias.fill_(100)
    actions = [tuple(policy.select_action(batch)[0].tolist()) for _ in range(choices)]
    assert len(set(actions)) == choices
    policy.reset()
    assert tuple(policy.select_action(batch)[0].tolist()) == actions[0]


def scores_of(policy, batch):
    """The network's scores, (B, N), where every other row has failed before."""
    sets = batch["observation.instances"]
    failed = choosable(sets) & (torch.arange(sets.shape[1]) % 2 == 0)
    tokens = tokens_of_prompts(batch["observation.prompt"], policy.config.prompt_tokens)
    preference = policy.network.encode(*tokens)
    situations = Situations(sets, failed, sets[:, :0])
    return policy.network.decide(situations, preference, torch.arange(len(sets)))


@BOTH
@pytest.mark.parametrize("seed", range(5))
def test_padding_changes_no_score(settings, seed):
    policy = perturbed(make_policy(**settings), seed)
    for decision in range(0, 20, 2):
        batch = observations([0], decision)
        real = is_real(batch["observation.instances"])[0]
        padded = scores_of(policy, batch)[:, real]
        batch["observation.instances"] = batch["observation.instances"][:, real]
        assert torch.allclose(scores_of(policy, batch), padded, atol=1e-3)


def test_an_object_out_of_reach_of_every_place_changes_no_place_s_score():
    policy = perturbed(make_policy(**COMPACT), 0)
    batch = observations([0, 1], 3)  # where the first dish is put
    before = scores_of(policy, batch)
    sets = batch["observation.instances"]
    is_place = sets[..., IS_PLACE] > 0
    assert is_place.any(dim=1).all()
    counter = (sets[..., IS_OBJECT] > 0) & (sets[..., POSITION][..., 1] > 0)
    assert counter.any()
    sets[..., POSITION][counter] += 1.0
    assert torch.equal(scores_of(policy, batch)[is_place], before[is_place])


@BOTH
@pytest.mark.parametrize("attribute", ["pose", "category", "time"])
def test_a_hidden_attribute_changes_no_score(settings, attribute):
    settings = settings | {"situation_time": True}
    policy, sees_all = make_policy(**settings, hidden=[attribute]), make_policy(**settings)
    batch = observations([0, 1], 3)
    changed = {key: rows.clone() for key, rows in batch.items()}
    for rows in changed.values():
        rows[..., ATTRIBUTES[attribute]] += 1.5 * is_real(rows)[..., None]
    real = is_real(batch["observation.instances"])
    before, after = (scores_of(policy, b)[real] for b in (batch, changed))
    assert torch.equal(before, after)
    before, after = (scores_of(sees_all, b)[real] for b in (batch, changed))
    assert not torch.allclose(before, after)


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
    "settings",
    [
        {"pointer": "rows"},
        {"prompt_tokens": "all"},
        {"dtype": "float16"},
        {"n_heads": 3},
        {"rounds": 0},
        {"context_history": -1},
        {"hidden": ["colour"]},
    ],
)
def test_impossible_settings_are_refused(settings):
    with pytest.raises(ValueError, match=next(iter(settings)).removeprefix("n_")):
        TTPConfig(device="cpu", **settings)

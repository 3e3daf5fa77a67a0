"""Learning from rewards: rows as actions, masks, and the command from training to evaluation."""

import json
from copy import deepcopy
from shutil import copytree

import numpy as np
import pytest
import torch
from safetensors.torch import load_file
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv
from typer.testing import CliRunner

from kitchen_prefs import instances
from kitchen_prefs.cli import command_line
from kitchen_prefs.envs.demonstrations import demonstrate
from kitchen_prefs.envs.simulator import LIMIT_FACTOR
from kitchen_prefs.evaluation.checkpoint_reading import read_config, read_policy
from kitchen_prefs.evaluation.episode_files import read_episodes
from kitchen_prefs.instances import CAPACITY, POSE
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs_experiments.reinforcement.checkpoint_writing import (
    last_checkpoint,
    pretrained_model,
    restore,
    save_checkpoint,
)
from kitchen_prefs_experiments.reinforcement.configuration import Args, read_args
from kitchen_prefs_experiments.reinforcement.ppo import make_learner
from kitchen_prefs_experiments.reinforcement.row_actions import RowActions
from kitchen_prefs_experiments.reinforcement.trainer import make_policy
from lerobot_policy_kitchen_prefs.ttp import TTPConfig

pytestmark = pytest.mark.xdist_group("reinforcement")  # one fixture of the module serves all

# A small network with 32 decisions between two updates.
TINY = (
    "--policy.dim=8",
    "--num_envs=2",
    "--n_steps=16",
    "--batch_size=16",
    "--n_epochs=2",
    "--save_freq=32",
)


def run(*arguments):
    result = CliRunner().invoke(command_line(), arguments)
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result.output


def reinforce(out, interactions, *more):
    return run("reinforce", f"--out={out}", f"--interactions={interactions}", *TINY, *more)


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """A run of 64 interactions in two parts."""
    out = tmp_path_factory.mktemp("runs") / "plain"
    reinforce(out, 32)
    output = reinforce(out, 64)
    assert "32 decisions in" in output
    assert "a second" in output
    return out


def weights(run, interactions):
    folder = run / "checkpoints" / f"{interactions:06d}"
    return load_file(folder / "pretrained_model" / "model.safetensors")


# The environment ---------------------------------------------------------------------------------


def row_of(environment, action):
    """The row whose pose an action is."""
    rows = environment._seen["instances"]
    matches = (rows[:, POSE] == action).all(axis=1) & instances.choosable(rows)
    return int(np.flatnonzero(matches)[0])


def test_stable_baselines_finds_nothing_wrong():
    check_env(RowActions(), warn=False)


def test_the_expert_s_rows_earn_its_rewards_and_pack_everything():
    environment, session = RowActions(), make_session("train", 3)
    environment.reset(seed=3)
    earned, done = [], False
    while not done:
        action = environment.env.simulator.expert_action()
        _, reward, done, truncated, info = environment.step(row_of(environment, action))
        earned.append(reward)
        assert not truncated
    assert earned == demonstrate(session).reward.tolist()
    assert info["PE"] == 1
    assert info["is_success"]


def test_sessions_are_the_published_ones_of_train_and_change():
    environment, seen = RowActions(), set()
    environment.reset(seed=1000)
    for _ in range(6):
        environment.reset()
        session = environment.env.session
        assert (session.split, session.salt) == ("train", 0)
        seen.add(session.index)
    assert len(seen) > 3


def test_a_row_that_cannot_be_chosen_is_refused_and_counts():
    environment = RowActions()
    before = deepcopy(environment.reset(seed=0)[0])
    limit = LIMIT_FACTOR * len(demonstrate(make_session("train", 0)).action)
    for decision in range(1, limit + 1):
        after, reward, terminated, truncated, info = environment.step(CAPACITY - 1)
        assert reward == 0
        assert info["refusal"]
        assert not terminated
        assert truncated == (decision == limit)
        np.testing.assert_equal(after, before)
    assert info["PE"] == 0


@pytest.mark.parametrize("seed", [0, 100, 300])
def test_the_mask_is_what_the_kitchen_would_carry_out(seed):
    environment, refused = RowActions(), 0
    environment.reset(seed=seed)
    for _ in range(25):
        mask = environment.action_masks()
        may_choose = np.flatnonzero(instances.choosable(environment._seen["instances"]))
        assert not np.delete(mask, may_choose).any()
        for row in may_choose:
            carried_out = not deepcopy(environment).step(row)[4]["refusal"]
            assert mask[row] == carried_out
            refused += not carried_out
        environment.step(row_of(environment, environment.env.simulator.expert_action()))
    assert refused > 25  # closed racks, the door, blocked placements


# Learning ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("masked", [False, True])
def test_masked_choices_are_never_refused_and_others_are(masked):
    args = read_args("gnn_rl", TINY)
    refusals = []

    class Spied(RowActions):
        def step(self, action):
            result = super().step(action)
            refusals.append(bool(result[4]["refusal"]))
            return result

    torch.manual_seed(0)
    environments = DummyVecEnv([Spied] * args.num_envs)
    make_learner(args, make_policy(args), environments, seed=0, masked=masked).learn(64)
    assert len(refusals) == 64
    assert any(refusals) == (not masked)


def test_only_what_a_decision_may_choose_has_a_chance():
    args = read_args("gnn_rl", TINY)
    environments = DummyVecEnv([RowActions] * args.num_envs)
    learner = make_learner(args, make_policy(args), environments, seed=0, masked=False)
    environments.reset()
    for _ in range(8):
        observation, _ = learner.policy.obs_to_tensor(environments.envs[0]._seen)
        chances = (
            learner.policy.get_distribution(observation).distribution.probs[0].detach().numpy()
        )
        sets = environments.envs[0]._seen["instances"]
        np.testing.assert_equal(chances > 0, instances.choosable(sets))
        environments.step([int(np.flatnonzero(chances)[-1])] * args.num_envs)


def test_a_run_resumes_and_learns(trained):
    last = trained / "checkpoints" / "last"
    assert last.resolve().name == "000064"
    step = json.loads((last / "training_state" / "training_step.json").read_text())["step"]
    assert step == 64
    before, after = weights(trained, 32), weights(trained, 64)
    assert all(not torch.equal(before[name], after[name]) for name in before)
    assert list((trained / "tensorboard").glob("events.*"))
    config = json.loads((last / "pretrained_model" / "config.json").read_text())
    assert config["pretrained_path"] is None


def test_a_resumed_run_restores_what_was_saved(tmp_path):
    args = read_args("gnn_rl", TINY)

    def learner_of(policy):
        environments = DummyVecEnv([lambda: Monitor(RowActions())] * args.num_envs)
        return make_learner(args, policy, environments, seed=0, masked=False)

    policy = make_policy(args)
    learner = learner_of(policy).learn(32)
    save_checkpoint(tmp_path, learner, policy)
    drawn = torch.rand(3)
    checkpoint = last_checkpoint(tmp_path)
    folder = pretrained_model(checkpoint)
    again = learner_of(read_policy(folder, read_config(folder, [])))
    restore(checkpoint, again)
    assert again.num_timesteps == 32
    assert torch.equal(torch.rand(3), drawn)
    torch.testing.assert_close(again.policy.state_dict(), learner.policy.state_dict())
    moments = again.policy.optimizer.state_dict()["state"]
    assert moments
    torch.testing.assert_close(moments, learner.policy.optimizer.state_dict()["state"])


def test_a_finished_run_is_left_alone(trained):
    assert "a second" not in reinforce(trained, 64)


def test_a_run_with_other_settings_is_refused(trained):
    with pytest.raises(ValueError, match="other settings"):
        reinforce(trained, 96, "--mask")
    with pytest.raises(ValueError, match="other settings"):
        reinforce(trained, 96, "--learning_rate=0.1")


@pytest.mark.slow
def test_evaluate_rolls_the_checkpoint_out_on_the_privileged_track(trained, tmp_path):
    checkpoint = trained / "checkpoints" / "last" / "pretrained_model"
    given = (f"--policy.path={checkpoint}", f"--out={tmp_path}", "--batch-size=30")
    run("evaluate", "--split=noisy", *given)
    assert len(read_episodes(tmp_path / "noisy.jsonl")) == 60
    conditions = json.loads((tmp_path / "noisy.json").read_text())["conditions"]
    assert (conditions["policy"], conditions["track"]) == ("gnn", "privileged")


@pytest.mark.parametrize(
    ("option", "message"),
    [
        ("--n_steps=20", "save_freq is a multiple .* 40; 32 is not"),
        ("--batch_size=12", "batch_size divides .* 32; 12 does not"),
        ("--num_envs=0", "num_envs is 0; it must be at least 1"),
        ("--policy.n_heads=0", "n_heads is 0; it must be at least 1"),
        ("--interactions=33", "updates of 32; give a multiple of that, not 33"),
        ("--n_epoch=3", "no setting 'n_epoch'.*'n_epochs'"),
        ("--policy.failures=true", "failures"),
        ("--recipe=ttp_quick", "ttp_quick"),
    ],
)
def test_what_cannot_be_done_is_refused(tmp_path, option, message):
    settings = ("--batch_size=8",) if option == "--n_steps=20" else ()
    with pytest.raises(ValueError, match=message):
        reinforce(tmp_path, 32, *settings, option)
    assert not list(tmp_path.iterdir())


def test_a_policy_that_scores_no_rows_is_named():
    with pytest.raises(ValueError, match="'ttp' scores no rows"):
        make_policy(Args(policy=TTPConfig(device="cpu")))


def test_somebody_else_s_run_is_left_alone(trained, tmp_path):
    copytree(trained, tmp_path / "run", symlinks=True)
    (tmp_path / "run" / "settings.json").unlink()  # lerobot-train writes none
    with pytest.raises(ValueError, match="another command"):
        reinforce(tmp_path / "run", 96)

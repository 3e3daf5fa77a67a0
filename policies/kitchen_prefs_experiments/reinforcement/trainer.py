"""Trains a policy by PPO; a run that was stopped resumes."""

import json
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import draccus
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.policies import get_policy_class
from lerobot.utils.constants import ACTION
from lerobot.utils.random_utils import set_seed
from sb3_contrib import MaskablePPO
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import configure
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.utils import safe_mean
from stable_baselines3.common.vec_env import DummyVecEnv
from tqdm import tqdm

from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, features_of
from kitchen_prefs.evaluation.checkpoint_reading import read_config, read_policy
from kitchen_prefs.utils.files import make_folder, write_json
from kitchen_prefs_experiments.reinforcement.checkpoint_writing import (
    interactions_of,
    last_checkpoint,
    pretrained_model,
    restore,
    save_checkpoint,
)
from kitchen_prefs_experiments.reinforcement.configuration import Args
from kitchen_prefs_experiments.reinforcement.ppo import make_learner
from kitchen_prefs_experiments.reinforcement.row_actions import RowActions

SETTINGS = "settings.json"


@dataclass(frozen=True)
class Pace:
    """The speed of a training.

    Attributes:
        interactions: The number of decisions.
        seconds: Their duration, learning included.
        rollout_seconds: The duration of the rollouts alone.
    """

    interactions: int
    seconds: float
    rollout_seconds: float


def reinforce(args: Args, interactions: int, masked: bool, run: Path) -> Pace:
    """Train until a number of interactions; a run that was stopped, or had fewer, resumes.

    Args:
        args: The recipe.
        interactions: The number of decisions in all.
        masked: Whether infeasible decisions are masked.
        run: The output folder.

    Returns:
        The speed; it has no interactions if the run had as many already.

    Raises:
        ValueError: If the folder holds a run with other settings, if the policy cannot be trained
            from rewards, or if the interactions are not a multiple of an update's.
        OSError: If the folder cannot be written.
    """
    settings = json.loads(json.dumps({"masked": masked, **draccus.encode(args)}))
    checkpoint = last_checkpoint(run)
    if interactions % args.rollout_size:
        raise ValueError(
            f"Interactions come in updates of {args.rollout_size:,}; give a multiple of that, not "
            f"{interactions:,}."
        )
    if checkpoint and _settings_of(run) != settings:
        raise ValueError(
            f"{run} is a run of another command or with other settings; give another --out or "
            "delete it."
        )
    learner, policy = _begin(args, masked, checkpoint)
    make_folder(run, "--out")
    write_json(run / SETTINGS, settings)
    learner.set_logger(configure(str(run / "tensorboard"), ["tensorboard"]))
    begun, start = learner.num_timesteps, perf_counter()
    watch = Watch(interactions)
    while learner.num_timesteps < interactions:
        more = min(args.save_freq, interactions - learner.num_timesteps)
        learner.learn(more, callback=watch, reset_num_timesteps=False)
        save_checkpoint(run, learner, policy)
    watch.close()
    return Pace(learner.num_timesteps - begun, perf_counter() - start, watch.rollout_seconds)


def make_policy(args: Args) -> Any:
    """Make a recipe's policy, with random weights.

    Raises:
        ValueError: If it is of a type that cannot learn from rewards.
    """
    policy_class: Any = get_policy_class(args.policy.type)
    if not hasattr(policy_class, "score_rows"):
        raise ValueError(
            f"{args.policy.type!r} scores no rows, so it cannot learn from rewards; take 'gnn'."
        )
    features = features_of("privileged")
    args.policy.input_features = {OBS_INSTANCES: features["instances"]}
    args.policy.output_features = {ACTION: PolicyFeature(FeatureType.ACTION, (7,))}
    return policy_class(args.policy).to(args.policy.device)


def _settings_of(run: Path) -> dict | None:
    """The settings that a run was started with; None if `reinforce` did not start it."""
    file = run / SETTINGS
    return json.loads(file.read_text()) if file.exists() else None


def _begin(args: Args, masked: bool, checkpoint: Path | None) -> tuple[PPO | MaskablePPO, Any]:
    """The learner and its policy, new or restored from a checkpoint."""
    done = interactions_of(checkpoint) if checkpoint else 0
    set_seed(args.seed)
    policy = _saved_policy(checkpoint) if checkpoint else make_policy(args)
    # In this process: a decision takes a tenth of a millisecond, and so would communication with
    # another process.
    environments = DummyVecEnv(
        [lambda: Monitor(RowActions(), info_keywords=("PE",))] * args.num_envs
    )
    # Another seed than at the start, so that a run that resumes continues with other sessions.
    learner = make_learner(args, policy, environments, args.seed + done, masked)
    if checkpoint:
        restore(checkpoint, learner)
    return learner, policy


def _saved_policy(checkpoint: Path) -> Any:
    folder = pretrained_model(checkpoint)
    policy = read_policy(folder, read_config(folder, []))
    policy.config.pretrained_path = None  # a path of this machine
    return policy


class Watch(BaseCallback):
    """Shows a progress bar, times the rollouts and logs packing efficiency."""

    def __init__(self, interactions: int) -> None:
        """Set the total number of interactions."""
        super().__init__()
        self.rollout_seconds = 0.0
        self._interactions = interactions
        self._bar: tqdm | None = None

    def close(self) -> None:
        """Finish the bar."""
        if self._bar is not None:
            self._bar.close()

    def _on_training_start(self) -> None:
        if self._bar is None:
            self._bar = tqdm(
                desc="Reinforcing",
                total=self._interactions,
                initial=self.num_timesteps,
                unit="decision",
            )

    def _on_rollout_start(self) -> None:
        self._start = perf_counter()

    def _on_step(self) -> bool:
        assert self._bar is not None
        self._bar.update(self.training_env.num_envs)
        return True

    def _on_rollout_end(self) -> None:
        self.rollout_seconds += perf_counter() - self._start
        efficiencies = [episode["PE"] for episode in self.model.ep_info_buffer or ()]
        self.logger.record("rollout/packing_efficiency", safe_mean(efficiencies))

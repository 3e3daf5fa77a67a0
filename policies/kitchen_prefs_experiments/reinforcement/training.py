"""Trains a policy by PPO, and goes on where a training was stopped."""

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
from kitchen_prefs_experiments.reinforcement.ppo import make_learner
from kitchen_prefs_experiments.reinforcement.row_actions import RowActions
from kitchen_prefs_experiments.reinforcement.settings import Settings

SETTINGS = "settings.json"


@dataclass(frozen=True)
class Pace:
    """How fast a training was.

    Attributes:
        interactions: Decisions that were played.
        seconds: What they took, learning included.
        playing: What playing alone took, in s.
    """

    interactions: int
    seconds: float
    playing: float


def reinforce(settings: Settings, interactions: int, masked: bool, run: Path) -> Pace:
    """Train until a number of interactions; a run that was stopped, or had fewer, goes on.

    Args:
        settings: The recipe.
        interactions: How many decisions are played in all.
        masked: Whether infeasible decisions are masked.
        run: The output folder.

    Returns:
        How fast it was; nothing was played if the run had as many interactions already.

    Raises:
        ValueError: If the folder holds a run with other settings, if the policy cannot learn from
            rewards, or if as many interactions cannot be played.
        OSError: If the folder cannot be written.
    """
    told = json.loads(json.dumps({"masked": masked, **draccus.encode(settings)}))
    checkpoint = last_checkpoint(run)
    if interactions % settings.rollout:
        raise ValueError(
            f"Interactions come in updates of {settings.rollout:,}; give a multiple of that, not "
            f"{interactions:,}."
        )
    if checkpoint and _told_before(run) != told:
        raise ValueError(
            f"{run} is a run of another command or with other settings; give another --out or "
            "delete it."
        )
    learner, policy = _begin(settings, masked, checkpoint)
    make_folder(run, "--out")
    write_json(run / SETTINGS, told)
    learner.set_logger(configure(str(run / "tensorboard"), ["tensorboard"]))
    begun, start = learner.num_timesteps, perf_counter()
    watch = Watch(interactions)
    while learner.num_timesteps < interactions:
        more = min(settings.save_freq, interactions - learner.num_timesteps)
        learner.learn(more, callback=watch, reset_num_timesteps=False)
        save_checkpoint(run, learner, policy)
    watch.close()
    return Pace(learner.num_timesteps - begun, perf_counter() - start, watch.playing)


def make_policy(settings: Settings) -> Any:
    """Make a recipe's policy, which has learned nothing yet.

    Raises:
        ValueError: If it is of a type that cannot learn from rewards.
    """
    policy_class: Any = get_policy_class(settings.policy.type)
    if not hasattr(policy_class, "score_rows"):
        raise ValueError(
            f"{settings.policy.type!r} scores no rows, so it cannot learn from rewards; take 'gnn'."
        )
    features = features_of("privileged")
    settings.policy.input_features = {OBS_INSTANCES: features["instances"]}
    settings.policy.output_features = {ACTION: PolicyFeature(FeatureType.ACTION, (7,))}
    return policy_class(settings.policy).to(settings.policy.device)


def _told_before(run: Path) -> dict | None:
    """What a run was begun with; None if it was not `reinforce` that began it."""
    file = run / SETTINGS
    return json.loads(file.read_text()) if file.exists() else None


def _begin(
    settings: Settings, masked: bool, checkpoint: Path | None
) -> tuple[PPO | MaskablePPO, Any]:
    """The learner and its policy, new or as a checkpoint left them."""
    done = interactions_of(checkpoint) if checkpoint else 0
    set_seed(settings.seed)
    policy = _saved_policy(checkpoint) if checkpoint else make_policy(settings)
    # They run in this process: a decision takes a tenth of a millisecond, asking another process
    # as long.
    environments = DummyVecEnv(
        [lambda: Monitor(RowActions(), info_keywords=("PE",))] * settings.environments
    )
    # Another seed than at the beginning: a run that goes on meets other sessions first.
    learner = make_learner(settings, policy, environments, settings.seed + done, masked)
    if checkpoint:
        restore(checkpoint, learner)
    return learner, policy


def _saved_policy(checkpoint: Path) -> Any:
    folder = pretrained_model(checkpoint)
    policy = read_policy(folder, read_config(folder, []))
    policy.config.pretrained_path = None  # where it lay on this machine is nobody's business
    return policy


class Watch(BaseCallback):
    """A progress bar, how long playing takes, and packing efficiency in the log."""

    def __init__(self, interactions: int) -> None:
        """Know how many interactions there will be."""
        super().__init__()
        self.playing = 0.0
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
        self.playing += perf_counter() - self._start
        efficiencies = [episode["PE"] for episode in self.model.ep_info_buffer or ()]
        self.logger.record("rollout/packing_efficiency", safe_mean(efficiencies))

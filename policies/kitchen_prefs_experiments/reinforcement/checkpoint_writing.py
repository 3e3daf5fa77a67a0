"""Checkpoints of reinforcement learning, laid out as `lerobot-train` lays out its own.

RUN/checkpoints/016000/
    pretrained_model/   the policy with its processors, as `kitchen-prefs evaluate` takes it
    training_state/     the optimiser, the random numbers, the interactions so far, the value head
RUN/checkpoints/last    a link to the last one
"""

from pathlib import Path

from lerobot.common.train_utils import (
    get_step_checkpoint_dir,
    load_training_step,
    save_training_state,
    update_last_checkpoint,
)
from lerobot.optim import load_optimizer_state
from lerobot.policies import PreTrainedPolicy, make_pre_post_processors
from lerobot.utils.constants import LAST_CHECKPOINT_LINK, PRETRAINED_MODEL_DIR, TRAINING_STATE_DIR
from lerobot.utils.random_utils import load_rng_state
from safetensors.torch import load_file, save_file
from sb3_contrib import MaskablePPO
from stable_baselines3 import PPO

from kitchen_prefs.utils.files import atomic_folder

VALUE_HEAD = "value_head.safetensors"


def last_checkpoint(run: Path) -> Path | None:
    """The last checkpoint of a run; None if it has none."""
    folder = run / "checkpoints" / LAST_CHECKPOINT_LINK
    return folder.resolve() if folder.exists() else None


def interactions_of(checkpoint: Path) -> int:
    """The number of interactions before a checkpoint."""
    return load_training_step(checkpoint / TRAINING_STATE_DIR)


def pretrained_model(checkpoint: Path) -> Path:
    """The folder of a checkpoint's policy."""
    return checkpoint / PRETRAINED_MODEL_DIR


def save_checkpoint(run: Path, learner: PPO | MaskablePPO, policy: PreTrainedPolicy) -> None:
    """Save a checkpoint atomically and link `last` to it."""
    interactions = learner.num_timesteps
    folder = get_step_checkpoint_dir(run, interactions, interactions)
    with atomic_folder(folder) as unfinished:
        policy.save_pretrained(pretrained_model(unfinished))
        for processor in make_pre_post_processors(policy.config):
            processor.save_pretrained(pretrained_model(unfinished))
        save_training_state(unfinished, interactions, learner.policy.optimizer)
        save_file(
            learner.policy.value_net.state_dict(), unfinished / TRAINING_STATE_DIR / VALUE_HEAD
        )
    update_last_checkpoint(folder)


def restore(checkpoint: Path, learner: PPO | MaskablePPO) -> None:
    """Restore the training state of a learner whose policy was loaded from a checkpoint."""
    state = checkpoint / TRAINING_STATE_DIR
    learner.policy.value_net.load_state_dict(load_file(state / VALUE_HEAD))
    load_optimizer_state(learner.policy.optimizer, state)
    load_rng_state(state)
    learner.num_timesteps = interactions_of(checkpoint)

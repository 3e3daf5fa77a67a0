"""ACT checkpoints for tests, and a way to spoil them."""

import json
from pathlib import Path

import torch
from lerobot.configs import FeatureType, PolicyFeature
from lerobot.policies import make_pre_post_processors
from lerobot.policies.act.configuration_act import ACTConfig
from lerobot.policies.act.modeling_act import ACTPolicy
from lerobot.utils.constants import ACTION, OBS_ENV_STATE, OBS_STATE
from typer.testing import CliRunner

from kitchen_prefs.envs.observations import ENVIRONMENT_STATE_SIZE, STATE_SIZE
from kitchen_prefs.evaluation import commands


def save_act(folder: Path, seed: int = 0, state_size: int = STATE_SIZE) -> Path:
    """Save an untrained ACT as `lerobot-train` saves a checkpoint."""
    config = ACTConfig(
        input_features={
            OBS_STATE: PolicyFeature(FeatureType.STATE, (state_size,)),
            OBS_ENV_STATE: PolicyFeature(FeatureType.ENV, (ENVIRONMENT_STATE_SIZE,)),
        },
        output_features={ACTION: PolicyFeature(FeatureType.ACTION, (7,))},
        device="cpu",
        chunk_size=4,
        n_action_steps=4,
        dim_model=16,
        n_heads=2,
        dim_feedforward=16,
        n_encoder_layers=1,
        n_decoder_layers=1,
        use_vae=False,
        pretrained_backbone_weights=None,
    )
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        policy = ACTPolicy(config)
    policy.save_pretrained(folder)
    for processor in make_pre_post_processors(config):
        processor.save_pretrained(folder)
    return folder


def call(*arguments: str):
    result = CliRunner().invoke(commands.app, arguments)
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    return result


def rewrite(file, change):
    """Change a JSON file in place."""
    content = json.loads(file.read_text())
    change(content)
    file.write_text(json.dumps(content))

"""Processors of the rules: LeRobot's default steps, with nothing normalised."""

from typing import Any

import torch
from lerobot.processor import (
    PolicyAction,
    PolicyProcessorPipeline,
    make_default_pre_post_processors,
)

from lerobot_policy_kitchen_prefs.rules.configuration_rules import RulesConfig


def make_rules_pre_post_processors(
    config: RulesConfig, dataset_stats: dict[str, dict[str, torch.Tensor]] | None = None
) -> tuple[
    PolicyProcessorPipeline[dict[str, Any], dict[str, Any]],
    PolicyProcessorPipeline[PolicyAction, PolicyAction],
]:
    """Make the pipelines before and after the policy (LeRobot's naming convention finds this)."""
    return make_default_pre_post_processors(config, dataset_stats)

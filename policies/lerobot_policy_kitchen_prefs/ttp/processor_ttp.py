"""The processors of TTP: LeRobot's default steps, with nothing normalised."""

from typing import Any

from lerobot.processor import (
    PolicyAction,
    PolicyProcessorPipeline,
    make_default_pre_post_processors,
)
from torch import Tensor

from .configuration_ttp import TTPConfig


def make_ttp_pre_post_processors(
    config: TTPConfig, dataset_stats: dict[str, dict[str, Tensor]] | None = None
) -> tuple[
    PolicyProcessorPipeline[dict[str, Any], dict[str, Any]],
    PolicyProcessorPipeline[PolicyAction, PolicyAction],
]:
    """Make LeRobot's default pipelines, whose normalisers do nothing here.

    Args:
        config: The policy's configuration; its normalization mapping is IDENTITY throughout.
        dataset_stats: The data set's statistics, which LeRobot keeps with the checkpoint.

    Returns:
        The pipeline before the policy and the one after it.
    """
    return make_default_pre_post_processors(config, dataset_stats)

"""The processors of the DeepSets policy; LeRobot finds them by their name."""

from lerobot.processor import PolicyProcessorPipeline, make_default_pre_post_processors

from kitchen_prefs.datasets.prompt_step import PromptStep
from lerobot_policy_kitchen_prefs.common.relabelling_step import RelabellingStep

from .configuration_deepsets import DeepSetsConfig


def make_deepsets_pre_post_processors(
    config: DeepSetsConfig, dataset_stats: dict | None = None
) -> tuple[PolicyProcessorPipeline, PolicyProcessorPipeline]:
    """LeRobot's default processors, and before them what training needs."""
    before, after = make_default_pre_post_processors(config, dataset_stats)
    training = [PromptStep.from_config(config), RelabellingStep.from_config(config)]
    before.steps = [*training, *before.steps]
    return before, after

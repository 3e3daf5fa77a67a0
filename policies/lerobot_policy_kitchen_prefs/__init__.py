"""The policies of kitchen_prefs.

LeRobot imports this package because of its name; that registers the policies, the environment and
the processor steps.
"""

import kitchen_prefs.envs.lerobot_env  # noqa: F401  registers --env.type=kitchen_prefs
from kitchen_prefs.datasets.prompt_step import PromptStep
from kitchen_prefs.utils.decoder_log import shorten_decoder_warning
from lerobot_policy_kitchen_prefs import gnn, rules, ttp, ttp_plan
from lerobot_policy_kitchen_prefs.common.relabelling_step import RelabellingStep

__all__ = ["PromptStep", "RelabellingStep", "gnn", "rules", "ttp", "ttp_plan"]

shorten_decoder_warning()  # in lerobot-train, which imports this package first

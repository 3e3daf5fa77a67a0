"""Policies that need no training: the floor, the references and the ceiling of every table."""

from lerobot_policy_kitchen_prefs.rules.configuration_rules import RulesConfig
from lerobot_policy_kitchen_prefs.rules.modeling_rules import RulesPolicy
from lerobot_policy_kitchen_prefs.rules.processor_rules import make_rules_pre_post_processors

__all__ = ["RulesConfig", "RulesPolicy", "make_rules_pre_post_processors"]

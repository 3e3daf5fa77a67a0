"""TTP with a plan: it reads where a user's dishes go and when, then decides (second tier)."""

from .configuration_ttp_plan import PlanTTPConfig
from .modeling_ttp_plan import PlanTTPPolicy
from .processor_ttp_plan import make_ttp_plan_pre_post_processors

__all__ = ["PlanTTPConfig", "PlanTTPPolicy", "make_ttp_plan_pre_post_processors"]

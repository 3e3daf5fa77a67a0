"""TTP, the Transformer Task Planner: a preference from one demonstration (paper, section 2)."""

from .configuration_ttp import TTPConfig
from .modeling_ttp import TTPPolicy
from .processor_ttp import make_ttp_pre_post_processors

__all__ = ["TTPConfig", "TTPPolicy", "make_ttp_pre_post_processors"]

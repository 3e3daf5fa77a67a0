"""The processors of TTP with a plan: LeRobot's default steps, with nothing normalised.

LeRobot finds them by this module's and this function's name.
"""

from lerobot.processor import make_default_pre_post_processors as make_ttp_plan_pre_post_processors

__all__ = ["make_ttp_plan_pre_post_processors"]

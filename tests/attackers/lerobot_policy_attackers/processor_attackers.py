"""The processors of the attackers."""

from lerobot.processor import make_default_pre_post_processors as make_attackers_pre_post_processors

__all__ = ["make_attackers_pre_post_processors"]

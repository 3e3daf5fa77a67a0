"""A plug-in of policies that try to win without a policy: what outsiders have tried."""

from lerobot_policy_attackers.configuration_attackers import AttackersConfig

__all__ = ["AttackersConfig"]

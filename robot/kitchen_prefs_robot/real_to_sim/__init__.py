"""From what the robot sees to what the policy reads."""

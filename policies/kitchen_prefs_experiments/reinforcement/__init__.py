"""Learning from rewards: a policy that scores rows plays in the kitchen and improves by PPO."""

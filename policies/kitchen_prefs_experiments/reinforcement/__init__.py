"""`kitchen-prefs reinforce`: trains a policy that scores rows from rewards, by PPO.

configuration       the policy and the constants of PPO
row_actions         the environment whose actions are rows of the instance set
ppo                 stable-baselines3's PPO around a LeRobot policy
trainer             trains, and resumes a run that was stopped
checkpoint_writing  checkpoints as lerobot-train lays them out
commands            the command
"""

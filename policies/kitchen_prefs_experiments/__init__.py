"""Trains and compares policies.

recipes        the training recipes, YAML files
checkpoints    trained checkpoints by name, verified
commands       `kitchen-prefs train` and `kitchen-prefs checkpoints`
markdown       tables in Markdown
lerobot_train  runs of lerobot-train on a recipe
quickstart     `kitchen-prefs quickstart`: from nothing to a scored policy
reinforcement  `kitchen-prefs reinforce`: PPO from the environment's rewards
paper          `kitchen-prefs reproduce` and `kitchen-prefs results`: the paper's tables
"""

"""A benchmark of preferences: demonstrations of loading a dishwasher, and a kitchen for rollouts.

dataset = kitchen_prefs.load_dataset("dishwasher-train-v1")
environment = gymnasium.make("kitchen_prefs/DishwasherLoading-v0", split="seen")
"""

import gymnasium

from kitchen_prefs.datasets import dataset_names, load_dataset

__all__ = ["dataset_names", "load_dataset"]

gymnasium.register(
    "kitchen_prefs/DishwasherLoading-v0",
    entry_point="kitchen_prefs.envs.environment:DishwasherLoading",
)
gymnasium.register(
    "kitchen_prefs/DishwasherPeople-v0",
    entry_point="kitchen_prefs.envs.people_environment:DishwasherPeople",
)

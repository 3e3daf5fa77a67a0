"""kitchen_prefs: can a policy learn how THIS person loads a dishwasher, from one demonstration?

    dataset = kitchen_prefs.load_dataset("dishwasher-train-v1")  # a LeRobotDataset, made if missing
    env = gymnasium.make("kitchen_prefs/DishwasherLoading-v0", split="seen")
"""

from typing import TYPE_CHECKING

import gymnasium

if TYPE_CHECKING:
    from lerobot.datasets import LeRobotDataset

__version__ = "0.1.0"

gymnasium.register(
    "kitchen_prefs/DishwasherLoading-v0",
    entry_point="kitchen_prefs.environment:DishwasherLoading",
)


def load_dataset(name: str) -> "LeRobotDataset":
    """Load a data set by its name, making it first if it is not there.

    Args:
        name: For example "dishwasher-train-v1"; `kitchen-prefs datasets list` names all.

    Returns:
        The data set; its files lie under `$HF_LEROBOT_HOME/kitchen_prefs/<name>`.

    Raises:
        ValueError: If there is no such data set, or if the one on disk is damaged.
    """
    from kitchen_prefs.datasets import load_dataset as load  # LeRobot takes seconds to import

    return load(name)

"""What a picture of the kitchen shows: plain numbers, no MuJoCo."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

# A dish: its category, position (3,) m and quaternion (4,) wxyz in the world.
SceneDish = tuple[str, np.ndarray, np.ndarray]


@dataclass(frozen=True, eq=False)
class SceneState:
    """One moment in the kitchen.

    Attributes:
        door_open: Whether the dishwasher's door is open.
        bottom_out: Whether the bottom rack is pulled out.
        top_out: Whether the top rack is pulled out.
        dishes: Every dish to draw, those in racks and in the sink included. A dish's number in this
            sequence chooses its colour.
    """

    door_open: bool = False
    bottom_out: bool = False
    top_out: bool = False
    dishes: Sequence[SceneDish] = field(default_factory=tuple)

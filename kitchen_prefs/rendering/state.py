"""What a picture of the kitchen shows, in plain numbers: no MuJoCo is needed."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.kitchen import Kitchen, Location

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


def scene_of(kitchen: Kitchen, opened: bool = False) -> SceneState:
    """A kitchen as a picture shows it.

    Args:
        kitchen: The kitchen.
        opened: Show the door open and both racks pulled out whatever they are, so that the load is
            in sight.
    """
    poses = kitchen.pose if opened else kitchen.pose_in_world()  # (n, 7)
    dishes = tuple(
        (CATEGORIES[kitchen.dishes.category[i]], pose[:3], pose[3:])
        for i, pose in enumerate(poses)
        if kitchen.location[i] != Location.NOT_ARRIVED
    )
    if opened:
        return SceneState(door_open=True, bottom_out=True, top_out=True, dishes=dishes)
    return SceneState(
        kitchen.door_open, kitchen.open_rack == "bottom", kitchen.open_rack == "top", dishes
    )

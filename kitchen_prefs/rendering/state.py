"""What a picture of the kitchen shows, in plain numbers: no MuJoCo is needed."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from kitchen_prefs.people.attributes import COLOURS, MATERIALS, DescribedDishes
from kitchen_prefs.preferences import CATEGORIES
from kitchen_prefs.simulation.kitchen import IN_RACK, Kitchen, Location


class Look(NamedTuple):
    """What is seen of a dish of the second tier beside its category.

    Attributes:
        material: One of `people.attributes.MATERIALS`.
        colour: One of `people.attributes.COLOURS`.
        greasy: Whether food sticks to it.
        scale: By how much it is larger than its category's extents.
    """

    material: str
    colour: str
    greasy: bool = False
    scale: float = 1.0


class SceneDish(NamedTuple):
    """A dish in a picture.

    Attributes:
        category: One of `kitchen_prefs.preferences.CATEGORIES`.
        position: In the world, (3,) m.
        quaternion: In the world, (4,) wxyz.
        look: Of a dish of the second tier; without it the dish's number chooses its colour.
    """

    category: str
    position: np.ndarray
    quaternion: np.ndarray
    look: Look | None = None


@dataclass(frozen=True, eq=False)
class SceneState:
    """One moment in the kitchen.

    Attributes:
        door_open: Whether the dishwasher's door is open.
        bottom_out: Whether the bottom rack is pulled out.
        top_out: Whether the top rack is pulled out.
        dishes: Every dish to draw, those in racks and in the sink included.
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
    dishes = _dishes(kitchen, poses, kitchen.location != Location.NOT_ARRIVED)
    if opened:
        return SceneState(door_open=True, bottom_out=True, top_out=True, dishes=dishes)
    return SceneState(
        kitchen.door_open, kitchen.open_rack == "bottom", kitchen.open_rack == "top", dishes
    )


def rack_scene(kitchen: Kitchen, rack: str) -> SceneState:
    """One rack pulled out with its load and nothing else, whatever is out now."""
    dishes = _dishes(kitchen, kitchen.pose, kitchen.location == IN_RACK[rack])
    return SceneState(True, rack == "bottom", rack == "top", dishes)


def sink_scene(kitchen: Kitchen) -> SceneState:
    """The closed kitchen with what lies in the sink and nothing else."""
    return SceneState(dishes=_dishes(kitchen, kitchen.pose, kitchen.location == Location.SINK))


def looks_of(kitchen: Kitchen) -> Sequence[Look | None]:
    """How each dish of a kitchen looks, (n,); None for those of the first tier."""
    dishes = kitchen.dishes
    if not isinstance(dishes, DescribedDishes):
        return [None] * len(dishes.category)
    colours = tuple(COLOURS)
    return [
        Look(MATERIALS[material], colours[colour], bool(greasy), float(scale))
        for material, colour, greasy, scale in zip(
            dishes.material, dishes.colour, dishes.greasy, dishes.scale, strict=True
        )
    ]


def _dishes(kitchen: Kitchen, poses: np.ndarray, shown: np.ndarray) -> tuple[SceneDish, ...]:
    """Those of a kitchen's dishes that are shown, (n,) bool, in poses, (n, 7)."""
    looks = looks_of(kitchen)
    return tuple(
        SceneDish(CATEGORIES[kitchen.dishes.category[i]], poses[i, :3], poses[i, 3:], looks[i])
        for i in np.flatnonzero(shown)
    )

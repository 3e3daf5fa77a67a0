"""What an experiment leaves to the robot, and what it gives."""

from dataclasses import dataclass
from typing import Literal, get_args

from kitchen_prefs.utils.suggestions import suggest
from kitchen_prefs_robot.scene.tableware import Colours

PerceivedBy = Literal["cameras", "truth"]
GraspedBy = Literal["arm", "truth"]
CHOICES = {
    "perception": get_args(PerceivedBy),
    "grasps": get_args(GraspedBy),
    "colours": get_args(Colours),
}


@dataclass(frozen=True)
class Conditions:
    """How a scene is seen and acted in.

    Attributes:
        perception: "cameras", or "truth" for categories and poses as they are.
        grasps: "arm", or "truth" for an invisible hand that never fails.
        colours: Of the dishes, "distinct" or "alike".
        lamp: How much the light changes at most, as a share of its brightness.
        depth_noise: Multiplies the depth's error.
        camera_error: m by which each camera's estimated position is off, standard deviation of each
            coordinate, beside the error of the calibration by tags.
        grasp_failures: The share of picks that are led astray, so that the hand misses the dish or
            pushes it.

    Raises:
        ValueError: If perception, grasps or colours are none of those.
    """

    perception: PerceivedBy = "cameras"
    grasps: GraspedBy = "arm"
    colours: Colours = "distinct"
    lamp: float = 0.1
    depth_noise: float = 1.0
    camera_error: float = 0.0
    grasp_failures: float = 0.0

    def __post_init__(self) -> None:
        for name, allowed in CHOICES.items():
            if (chosen := getattr(self, name)) not in allowed:
                raise ValueError(f"There are no {name} {chosen!r}. {suggest(str(chosen), allowed)}")


REAL = Conditions()

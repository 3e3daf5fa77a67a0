"""What the robot is prompted with: a person's demonstration in another scene."""

import numpy as np

from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.demonstrations.recording import record
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.looking import TrueEyes
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.sessions import DrawersSession
from kitchen_prefs_robot.task.state import DrawersState

OTHER_SCENES = 100_000  # the scene of a demonstration, counted from the one that is loaded


def prompt_for(scene: int, preference: int, conditions: Conditions) -> np.ndarray:
    """A demonstration of a preference, perceived as the scene is.

    Args:
        scene: The seed of the scene that will be loaded; the demonstration is in another.
        preference: The number of the preference, see `demonstrations.preferences`.
        conditions: How the demonstration is perceived.

    Returns:
        The prompt, (1664, 14) float32.

    Raises:
        ValueError: If what the cameras see is no demonstration.
    """
    shown_in = OTHER_SCENES + scene
    if conditions.perception == "cameras":
        light = (conditions.colours, conditions.lamp, conditions.depth_noise)
        return record(shown_in, preference, *light).prompt
    shown = human_preference(preference)
    looked = TrueEyes(World(sample_scene(shown_in, shown.categories)), shown_in).look()
    start = DrawersState(tuple(dish.seen for dish in looked.dishes), None, None)
    session = DrawersSession("test", shown_in, "prompt", preference, shown, start)
    return demonstrate(session).prompt

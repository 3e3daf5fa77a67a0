"""What the robot is prompted with: a person's demonstration in another scene."""

from contextlib import suppress
from functools import cache
from pathlib import Path

import numpy as np

from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.demonstrations.recording import record
from kitchen_prefs_robot.demonstrations.storage import read_prompt, require_same_dishes
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.looking import TrueEyes
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.scene.tableware import Colours
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.sessions import DrawersSession
from kitchen_prefs_robot.task.state import DrawersState

OTHER_SCENES = 100_000  # the scene of a demonstration, counted from the one that is loaded
ATTEMPTS, AGAIN = 3, 100_000  # demonstrations until one is understood, and how far apart they are


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
        return _recorded(shown_in, preference, *light)
    shown = human_preference(preference)
    looked = TrueEyes(World(sample_scene(shown_in, shown.categories)), shown_in).look()
    start = DrawersState(tuple(dish.seen for dish in looked.dishes), None, None)
    session = DrawersSession("test", shown_in, "prompt", preference, shown, start)
    return demonstrate(session).prompt


def prompt_from(demonstration: str, preference: int) -> np.ndarray:
    """A recorded demonstration as a prompt.

    Args:
        demonstration: The folder of a data set, or FOLDER:EPISODE.
        preference: It names the dishes of the scene, which the demonstration must show.

    Raises:
        ValueError: If there is no such demonstration, or if it shows other dishes.
    """
    folder, _, episode = demonstration.partition(":")
    number = int(episode) if episode.isdigit() else 0
    require_same_dishes(Path(folder), number, human_preference(preference).categories)
    return read_prompt(Path(folder), number)


@cache  # a table prompts many variations with one demonstration; it has .1 MB
def _recorded(
    shown_in: int, preference: int, colours: Colours, lamp: float, depth_noise: float
) -> np.ndarray:
    """A person who was not understood shows it again in another scene."""
    light = (colours, lamp, depth_noise)
    for attempt in range(ATTEMPTS - 1):
        with suppress(ValueError):
            return record(shown_in + attempt * AGAIN, preference, *light).prompt
    return record(shown_in + (ATTEMPTS - 1) * AGAIN, preference, *light).prompt

"""What the robot is prompted with: a person's demonstration in another scene."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from kitchen_prefs_robot.demonstrations.loading import read_origin, read_prompt
from kitchen_prefs_robot.demonstrations.preferences import human_preference
from kitchen_prefs_robot.demonstrations.recording import record
from kitchen_prefs_robot.execution.conditions import Conditions
from kitchen_prefs_robot.execution.looking import TrueEyes
from kitchen_prefs_robot.scene import World, sample_scene
from kitchen_prefs_robot.scene.tableware import Colours
from kitchen_prefs_robot.task.demonstrations import demonstrate
from kitchen_prefs_robot.task.sessions import DrawersSession
from kitchen_prefs_robot.task.state import DrawersState

OTHER_SCENES = 100_000  # the scene of a demonstration, counted from the one that is loaded
ATTEMPTS, AGAIN = 3, 100_000  # demonstrations until one is understood, and how far apart they are


@dataclass(frozen=True)
class Prompt:
    """A demonstration as a policy reads it, and how well it was understood.

    Attributes:
        rows: The sets of all decisions, the chosen rows marked, (1664, 14) float32.
        shown: How many demonstrations were shown until one was understood.
        misread: Own category, and the one that it was taken for, of each dish that was misread.
    """

    rows: np.ndarray
    shown: int = 1
    misread: tuple[tuple[str, str], ...] = ()


class NotUnderstoodError(ValueError):
    """None of a person's demonstrations was understood."""


def prompt_for(scene: int, preference: int, conditions: Conditions) -> Prompt:
    """A demonstration of a preference, perceived as the scene is.

    A person whom the cameras do not understand shows it again in another scene, twice at most.

    Args:
        scene: The seed of the scene that will be loaded; the demonstration is in another.
        preference: The number of the preference, see `demonstrations.preferences`.
        conditions: How the demonstration is perceived.

    Raises:
        NotUnderstoodError: If none of the demonstrations is understood.
    """
    shown_in = OTHER_SCENES + scene
    if conditions.perception == "cameras":
        light = (conditions.colours, conditions.lamp)
        return _recorded(
            shown_in, preference, *light, conditions.depth_noise, conditions.camera_error
        )
    shown = human_preference(preference)
    looked = TrueEyes(World(sample_scene(shown_in, shown.categories)), shown_in).look()
    start = DrawersState(tuple(dish.seen for dish in looked.dishes), None, None)
    session = DrawersSession("test", shown_in, "prompt", preference, shown, start)
    return Prompt(demonstrate(session).prompt)


def prompt_from(demonstration: str, scene: int, preference: int) -> Prompt:
    """A recorded demonstration as a prompt.

    Args:
        demonstration: The folder of a data set, or FOLDER:EPISODE.
        scene: The seed of the scene that will be loaded, which the demonstration must not show.
        preference: The number of the preference, which the demonstration must show.

    Raises:
        ValueError: If there is no such demonstration, or if it shows something else.
    """
    folder, episode = _folder_and_episode(demonstration)
    origin = read_origin(folder, episode)
    if origin.preference != preference:
        raise ValueError(
            f"Episode {episode} of {folder} shows preference {origin.preference}, not "
            f"{preference}; give --preference={origin.preference}, or another episode."
        )
    if origin.scene == scene:
        raise ValueError(
            f"Episode {episode} of {folder} shows scene {scene} itself; give another --scene, or "
            "another episode."
        )
    return Prompt(read_prompt(folder, episode), misread=origin.misread)


def _folder_and_episode(demonstration: str) -> tuple[Path, int]:
    folder, colon, episode = demonstration.rpartition(":")
    if not colon:
        return Path(demonstration), 0
    if not folder or not (episode.isascii() and episode.isdecimal()):
        raise ValueError(
            f"A demonstration is FOLDER or FOLDER:EPISODE with a number from 0, unlike "
            f"{demonstration!r}."
        )
    return Path(folder), int(episode)


@cache  # a table prompts many variations with one demonstration; it has .1 MB
def _recorded(
    shown_in: int,
    preference: int,
    colours: Colours,
    lamp: float,
    depth_noise: float,
    camera_error: float,
) -> Prompt:
    """The first demonstration that is understood."""
    seen_with = (colours, lamp, depth_noise, camera_error)
    reason = ""
    for attempt in range(ATTEMPTS):
        try:
            shown = record(shown_in + attempt * AGAIN, preference, *seen_with)
        except ValueError as error:
            reason = str(error)
        else:
            return Prompt(shown.prompt, attempt + 1, shown.misread)
    raise NotUnderstoodError(
        f"None of {ATTEMPTS} demonstrations was understood; give another --scene. {reason}"
    )

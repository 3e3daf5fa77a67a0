"""Pictures of an episode, drawn by replaying its actions in the kitchen."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image
from tqdm import tqdm

from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.metrics import Episode
from kitchen_prefs.rendering.renderer import Renderer

FIGURE_SIZE = (1280, 960)
FRAME_SIZE = (480, 360)
FRAME_MS = 350  # long enough to see what each decision did
LAST_FRAME_MS = 2500


def draw_episode(episode: Episode, folder: Path) -> None:
    """Draw start.png, end.png (with the racks pulled out, to show the load) and episode.gif.

    Args:
        episode: The episode whose actions are replayed.
        folder: The output folder.
    """
    environment = DishwasherLoading(episode.split)
    environment.reset(options={"session": episode.session, "salt": episode.salt})
    figure = Renderer(*FIGURE_SIZE, "fine")
    Image.fromarray(figure.render(environment.scene())).save(folder / "start.png")
    frames = list(_frames(environment, episode))
    Image.fromarray(figure.render(environment.scene(opened=True))).save(folder / "end.png")
    figure.close()
    frames[0].save(
        folder / "episode.gif",
        save_all=True,
        append_images=frames[1:],
        duration=[FRAME_MS] * (len(frames) - 1) + [LAST_FRAME_MS],
        loop=0,
    )


def _frames(environment: DishwasherLoading, episode: Episode) -> Iterator[Image.Image]:
    renderer = Renderer(*FRAME_SIZE, "fast")
    yield Image.fromarray(renderer.render(environment.scene()))
    for action in tqdm(episode.actions, desc="episode.gif", unit="frame"):
        environment.step(np.array(action))
        yield Image.fromarray(renderer.render(environment.scene()))
    renderer.close()

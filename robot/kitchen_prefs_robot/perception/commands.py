"""`kitchen-prefs robot perception`: how well the cameras' pictures are understood.

MuJoCo is imported inside the command, so that `kitchen-prefs --help` does not wait for it.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import typer
from rich.console import Console
from rich.table import Table
from tqdm import trange

from kitchen_prefs.utils.files import atomic_file

if TYPE_CHECKING:
    from kitchen_prefs_robot.perception.trials import Trial


def perception(
    scenes: Annotated[int, typer.Option(min=1, help="How many random scenes.")] = 200,
    first: Annotated[
        int, typer.Option(min=0, help="The seed of the first; settings were chosen on 0 to 49.")
    ] = 1000,
    colours: Annotated[
        Literal["distinct", "alike"], typer.Option(help="Of the dishes.")
    ] = "distinct",
    lamp: Annotated[
        float, typer.Option(min=0, max=0.5, help="How much the light changes at most, a share.")
    ] = 0.2,
    depth_noise: Annotated[float, typer.Option(min=0, help="Times the camera's own noise.")] = 1.0,
    picture: Annotated[
        Path | None, typer.Option(help="PNG of the first scene with its clusters.")
    ] = None,
) -> None:
    """Look at random scenes, and count what dishes are taken for and how far positions err.

    Example: kitchen-prefs robot perception --scenes=50 --colours=alike --lamp=0.2
    """
    from kitchen_prefs_robot.perception.known_dishes import known_dishes
    from kitchen_prefs_robot.perception.trials import run_trial

    known = known_dishes(colours=colours)
    if picture:
        _save_picture(picture, first, colours, lamp, depth_noise)
    trials = [
        run_trial(seed, known, colours, lamp, depth_noise)
        for seed in trange(first, first + scenes, desc="Looking at scenes", unit="scene")
    ]
    console = Console()
    categories = [dish.category for dish in known]
    console.print(_confusion_table(trials, categories), _error_table(trials, categories))
    _print_counts(console, trials)


def _confusion_table(trials: "list[Trial]", categories: list[str]) -> Table:
    from kitchen_prefs_robot.perception.trials import MISSED, UNKNOWN, confusion

    counts = confusion(trials)
    columns = [*categories, UNKNOWN, MISSED]
    table = Table("dish", *columns, title="Seen as")
    for category in categories:
        table.add_row(category, *(str(counts[category, column]) for column in columns))
    return table


def _error_table(trials: "list[Trial]", categories: list[str]) -> Table:
    """Mean distances in the plane, and of heights, in cm."""
    table = Table(
        "dish", "mean of points", "(height)", "middle of box", "(height)", title="Errors, cm"
    )
    for category in categories:
        dishes = [d for trial in trials for d in trial.dishes if d.category == category]
        errors = np.array([(dish.mean_error, dish.middle_error) for dish in dishes])  # (n, 2, 3)
        in_plane = np.nanmean(np.linalg.norm(errors[..., :2], axis=-1), axis=0)  # (2,)
        height = np.nanmean(abs(errors[..., 2]), axis=0)
        mean, middle = 100 * np.stack([in_plane, height], axis=1)
        table.add_row(category, *(f"{centimetres:.2f}" for centimetres in (*mean, *middle)))
    return table


def _print_counts(console: Console, trials: "list[Trial]") -> None:
    right = sum(trial.is_right for trial in trials)
    camera = np.concatenate([trial.camera_errors for trial in trials])  # (3 trials, 2)
    opening = np.abs([trial.opening_error for trial in trials])
    millimetres, degrees = 1000 * camera[:, 0], np.rad2deg(camera[:, 1])
    console.print(
        f"Scenes without any mistake: {right} of {len(trials)}.\n"
        f"Clusters that are no dish: {sum(trial.extra for trial in trials)}; too large for one "
        f"dish: {sum(trial.touching for trial in trials)}.\n"
        f"Cameras, from the tags: {np.median(millimetres):.1f} mm and {np.median(degrees):.2f} "
        f"degrees (median), {millimetres.max():.1f} mm and {degrees.max():.2f} degrees (largest).\n"
        f"Opening of a drawer: {1000 * np.median(opening):.1f} mm (median), "
        f"{1000 * opening.max():.1f} mm (largest)."
    )


def _save_picture(
    path: Path, scene: int, colours: Literal["distinct", "alike"], lamp: float, depth_noise: float
) -> None:
    from PIL import Image

    from kitchen_prefs_robot.perception.cameras import Cameras, laboratory_poses
    from kitchen_prefs_robot.perception.detection import perceive
    from kitchen_prefs_robot.perception.known_dishes import known_dishes
    from kitchen_prefs_robot.perception.pictures import beside_clusters
    from kitchen_prefs_robot.scene import World, sample_scene
    from kitchen_prefs_robot.scene.views import PICTURE_SIZE

    world, poses = World(sample_scene(scene, colours=colours, lamp=lamp)), laboratory_poses()
    with Cameras(world, poses, *PICTURE_SIZE, depth_noise) as cameras:
        frames = cameras.take()
        sight = perceive(cameras.cloud(frames), known_dishes(colours=colours))
    views = [beside_clusters(frame, poses[name], sight.dishes) for name, frame in frames.items()]
    with atomic_file(path) as unfinished:
        Image.fromarray(np.concatenate(views)).save(unfinished)

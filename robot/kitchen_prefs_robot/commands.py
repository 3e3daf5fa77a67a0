"""`kitchen-prefs robot`: what the simulated arm can do.

MuJoCo and the arm come with the extra `robot`, so the commands import them when they run.
"""

from collections import Counter
from importlib.util import find_spec
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table
from tqdm import tqdm

from kitchen_prefs.evaluation.policy_options import ANY_SETTING
from kitchen_prefs.metrics import wilson
from kitchen_prefs.rendering.opengl import NoOpenGLError
from kitchen_prefs_robot.demonstrations.commands import demonstrate, verify
from kitchen_prefs_robot.execution.commands import run, table
from kitchen_prefs_robot.perception.commands import perception
from kitchen_prefs_robot.task.commands import data, task

app = typer.Typer(
    name="robot", help="A simulated arm that loads two drawers.", no_args_is_help=True
)
app.command()(perception)
app.command()(demonstrate)
app.command()(verify)
app.command()(run)
app.command()(table)
app.command(context_settings=ANY_SETTING)(task)
app.command()(data)
console = Console()
ROBOT_MODULES = ("mujoco", "gym_hil", "mink", "fast_simplification", "sklearn")
WITHOUT_ROBOT = ("task", "data")  # commands that need no arm


@app.callback()
def require_robot(context: typer.Context) -> None:
    """Make sure that the extra `robot` is installed, where a command needs it.

    Raises:
        OSError: If it is not, or if `MUJOCO_GL` names an OpenGL that is not there; the message says
            what to install.
    """
    if context.invoked_subcommand in WITHOUT_ROBOT:
        return
    if not all(map(find_spec, ROBOT_MODULES)):
        raise OSError(
            "The robot needs MuJoCo, its arm and its kinematics: "
            "`pip install 'lerobot_policy_kitchen_prefs[robot]'`. Everything else works without it."
        )
    try:
        import mujoco  # noqa: F401
    except (ImportError, AttributeError) as error:  # with MUJOCO_GL set it loads OpenGL at once
        raise NoOpenGLError from error


@app.command()
def picks(
    picks: Annotated[int, typer.Option(help="The number of picks of each dish.", min=1)] = 100,
    pose_error: Annotated[
        float,
        typer.Option(help="m by which points are moved to the side, standard deviation.", min=0.0),
    ] = 0.0,
) -> None:
    """Pick single dishes: with points on all of their surface, and as three cameras see them.

    A pick succeeds where the dish hangs in the hand at its end. Each scene has all four dishes, and
    each is picked from it once.

    Example: kitchen-prefs robot picks --picks=100 --pose-error=0.0
    """
    from kitchen_prefs_robot.motion.seen_points import exact_points, seen_points
    from kitchen_prefs_robot.motion.trials import pick_each

    table = Table("points", "dish", "picked", "share [95 %]", "what the arm felt")
    for name, points_of in (("exact", exact_points), ("as seen", seen_points)):
        scenes = [
            pick_each(seed, points_of, pose_error)
            for seed in tqdm(range(picks), f"Picking by {name} points")
        ]
        for category in scenes[0]:
            picked = sum(scene[category][0] for scene in scenes)
            felt = Counter(scene[category][1] for scene in scenes).most_common()
            table.add_row(
                name,
                category,
                f"{picked} of {picks}",
                str(wilson(picked, picks)),
                ", ".join(f"{count} {result}" for result, count in felt),
            )
    console.print(table)


@app.command()
def drawers(
    times: Annotated[int, typer.Option(help="How often each is opened and closed.", min=1)] = 20,
    opening_error: Annotated[
        float,
        typer.Option(help="m by which openings are mistaken, standard deviation.", min=0.0),
    ] = 0.003,
) -> None:
    """Open and close each drawer by its handle.

    Example: kitchen-prefs robot drawers --times=20 --opening-error=0.003
    """
    from kitchen_prefs_robot.motion.trials import move_drawers
    from kitchen_prefs_robot.scene.layout import DRAWERS

    counts = [
        move_drawers(drawer, times, opening_error) for drawer in tqdm(DRAWERS, "Moving drawers")
    ]
    for drawer, count in zip(DRAWERS, counts, strict=True):
        typer.echo(
            f"{drawer}: opened {count['opened']} of {times}, closed {count['closed']} of {times}"
        )

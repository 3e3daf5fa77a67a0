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
from kitchen_prefs_robot.task.commands import data, task

app = typer.Typer(
    name="robot", help="A simulated arm that loads two drawers.", no_args_is_help=True
)
app.command(context_settings=ANY_SETTING)(task)
app.command()(data)
console = Console()
WITHOUT_ROBOT = ("task", "data")  # commands that need no arm


@app.callback()
def require_robot(context: typer.Context) -> None:
    """Make sure that the extra `robot` is installed, where a command needs it.

    Raises:
        OSError: If it is not; the message says how to install it.
    """
    if context.invoked_subcommand in WITHOUT_ROBOT:
        return
    if not all(map(find_spec, ("mujoco", "gym_hil", "mink", "fast_simplification"))):
        raise OSError(
            "The robot needs MuJoCo, its arm and its kinematics: "
            "`pip install 'lerobot_policy_kitchen_prefs[robot]'`. Everything else works without it."
        )


@app.command()
def picks(
    picks: Annotated[int, typer.Option(help="The number of picks of each dish.", min=1)] = 100,
    pose_error: Annotated[
        float,
        typer.Option(help="m by which points are moved to the side, standard deviation.", min=0.0),
    ] = 0.0,
) -> None:
    """Pick single dishes: with points on all of their surface, and as three cameras see them.

    A pick succeeds where the dish hangs in the hand at its end. Each is of another scene.

    Example: kitchen-prefs robot picks --picks=100 --pose-error=0.0
    """
    from kitchen_prefs_robot.motion.seen_points import exact_points, seen_points
    from kitchen_prefs_robot.motion.trials import pick_often
    from kitchen_prefs_robot.scene import PAPER_DISHES

    table = Table("dish", "points", "picked", "share [95 %]", "what the arm felt")
    for number, category in enumerate(PAPER_DISHES):
        for name, points_of in (("exact", exact_points), ("as seen", seen_points)):
            trials = pick_often(number, picks, points_of, pose_error)
            results = list(tqdm(trials, f"{category}, {name}", picks))
            picked = sum(lifted for lifted, _ in results)
            felt = Counter(result for _, result in results).most_common()
            table.add_row(
                category,
                name,
                f"{picked} of {picks}",
                str(wilson(picked, picks)),
                ", ".join(f"{count} {result}" for result, count in felt),
            )
    console.print(table)


@app.command()
def drawers(
    times: Annotated[int, typer.Option(help="How often each is opened and closed.", min=1)] = 20,
) -> None:
    """Open and close each drawer by its handle.

    Example: kitchen-prefs robot drawers --times=20
    """
    from kitchen_prefs_robot.motion.trials import move_drawers
    from kitchen_prefs_robot.scene.layout import DRAWERS

    for drawer in tqdm(DRAWERS, "Moving drawers"):
        counts = move_drawers(drawer, times)
        typer.echo(
            f"{drawer}: opened {counts['opened']} of {times}, closed {counts['closed']} of {times}"
        )

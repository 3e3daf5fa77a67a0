"""`kitchen-prefs robot task` and `kitchen-prefs robot data`: the drawers without the robot.

LeRobot and torch take many seconds to import, so the commands import what needs them when they run.
"""

from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from kitchen_prefs.evaluation.policy_options import settings_of

console = Console()


def task(
    context: typer.Context,
    path: Annotated[
        str, typer.Option("--policy.path", help="A checkpoint's folder, or its hub name.")
    ],
    sessions: Annotated[int, typer.Option(help="The number of sessions.", min=1)] = 200,
    split: Annotated[str, typer.Option(help="test, or val for choosing a checkpoint.")] = "test",
) -> None:
    """Evaluate a policy on the drawers without the robot, for better and for worse perception.

    Its sessions have preferences that training does not see; each is prompted with one
    demonstration in another session. "Right" is the share of dishes in the right drawer in the
    right order; a success is an episode with all dishes in the right drawers and both closed.
    Any other --policy.SETTING=VALUE overrides a setting of the policy.

    Example: kitchen-prefs robot task --policy.path=policies/checkpoints/ttp_drawers --sessions=200
    """
    from kitchen_prefs.evaluation.policy_loading import load_policy
    from kitchen_prefs.metrics import summarise, wilson_success
    from kitchen_prefs_robot.task.conditions import evaluate
    from kitchen_prefs_robot.task.metrics import METRICS
    from kitchen_prefs_robot.task.sessions import make_session

    chosen = [make_session(split, index) for index in range(sessions)]
    policy = load_policy(path, options=settings_of(context.args))
    table = Table("Condition", *METRICS, "Success", title=f"{split}, {sessions} sessions")
    for name, episodes in evaluate(policy, chosen):
        intervals = [summarise(episodes, metric) for metric in METRICS.values()]
        intervals.append(wilson_success(episodes))
        table.add_row(name, *(f"{interval.mean:.3f}" for interval in intervals))
        table.add_row("  95 % from", *(f"{interval.low:.3f}" for interval in intervals))
        table.add_row("         to", *(f"{interval.high:.3f}" for interval in intervals))
        table.add_section()
    console.print(table)


def data() -> None:
    """Make the demonstrations that `policies/recipes/ttp_drawers.yaml` trains on.

    Example: kitchen-prefs robot data
    """
    from kitchen_prefs_robot.task.dataset import NAME, make_dataset

    typer.echo(f"{NAME} is in {make_dataset()}")

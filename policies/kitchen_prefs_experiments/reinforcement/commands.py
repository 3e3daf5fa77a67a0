"""The command `kitchen-prefs reinforce`.

LeRobot and torch take seconds to import, so the command imports what needs them when it runs.
"""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from kitchen_prefs.evaluation.policy_options import ANY_SETTING

app = typer.Typer()
console = Console()


@app.command(context_settings=ANY_SETTING)
def reinforce(
    context: typer.Context,
    out: Annotated[Path, typer.Option(help="The folder of checkpoints and logs.")],
    interactions: Annotated[
        int, typer.Option(help="The total number of decisions.", min=1)
    ] = 32_000,  # the paper's budget
    recipe: Annotated[
        str, typer.Option(help="A recipe of reinforcement learning, by name.")
    ] = "gnn_rl",
    mask: Annotated[
        bool,
        typer.Option("--mask", help="Mask decisions that would be refused (an oracle)."),
    ] = False,
) -> None:
    """Train a policy by PPO from the paper's rewards, on the sessions of train (open track).

    A command that was stopped resumes; so does a finished one with more --interactions.
    The checkpoints are in LeRobot's format, for evaluate and select; the logs in OUT/tensorboard.
    Any other --SETTING=VALUE overrides a setting of the recipe.

    For example:
    kitchen-prefs reinforce --interactions=32000 --out=outputs/gnn_rl
    kitchen-prefs evaluate --split=seen --out=outputs/gnn_rl/evaluation
    --policy.path=outputs/gnn_rl/checkpoints/last/pretrained_model
    """
    from lerobot.utils.import_utils import register_third_party_plugins

    from kitchen_prefs_experiments.reinforcement.configuration import read_args
    from kitchen_prefs_experiments.reinforcement.trainer import reinforce as train

    register_third_party_plugins()
    pace = train(read_args(recipe, context.args), interactions, mask, out)
    if pace.interactions:
        console.print(
            f"{pace.interactions} decisions in {pace.seconds:.0f} s: "
            f"{pace.interactions / pace.seconds:.0f} a second, "
            f"{pace.interactions / pace.rollout_seconds:.0f} in rollouts alone."
        )
    console.print(f"The checkpoint is {out}/checkpoints/last/pretrained_model.")

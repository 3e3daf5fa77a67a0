"""`kitchen-prefs train` and `kitchen-prefs checkpoints`: recipes and checkpoints by name."""

import shutil
from pathlib import Path
from typing import Annotated

import typer

from kitchen_prefs.evaluation.policy_options import ANY_SETTING
from kitchen_prefs_experiments import checkpoints
from kitchen_prefs_experiments.recipes import recipe_file, training_data, training_recipes

app = typer.Typer()
group = typer.Typer(
    name="checkpoints", help="Find trained checkpoints by name.", no_args_is_help=True
)
app.add_typer(group)

Name = Annotated[str, typer.Argument(help="Such as ttp_quick.")]
DATASET_OPTION = "--dataset.repo_id="
OWN_DATA = "kitchen_prefs/"


@app.command(context_settings=ANY_SETTING)
def train(
    context: typer.Context,
    recipe: Annotated[str, typer.Option(help=f"Of {', '.join(training_recipes())}.")],
    out: Annotated[Path, typer.Option(help="The folder of the checkpoints.")],
) -> None:
    """Make the data of a recipe if they are missing, and train it by lerobot-train.

    A command that was stopped resumes from the last checkpoint; the log is OUT.log.
    Any other --SETTING=VALUE is an option of lerobot-train and overrides the recipe.

    For example:
    kitchen-prefs train --recipe=ttp_quick --out=outputs/ttp_quick
    kitchen-prefs select outputs/ttp_quick
    """
    from kitchen_prefs.datasets import make_dataset
    from kitchen_prefs_experiments.lerobot_train import TrainingRun

    data = _last_value(context.args, DATASET_OPTION) or training_data(recipe)
    if data.startswith(OWN_DATA):
        make_dataset(data)
    run = TrainingRun(out)
    options = " ".join([f"--output_dir={out}", *context.args])
    typer.echo(f"lerobot-train --config_path={recipe_file(recipe)} {options}")
    run.train(recipe, context.args)
    typer.echo(f"The last checkpoint is {run.checkpoint}.")


def _last_value(arguments: list[str], option: str) -> str | None:
    """The value of an option, of which the last one counts."""
    values = [text.removeprefix(option) for text in arguments if text.startswith(option)]
    return values[-1] if values else None


@group.command("list")
def list_checkpoints() -> None:
    """List the checkpoints.

    Example: kitchen-prefs checkpoints list
    """
    for name in checkpoints.read_manifest():
        typer.echo(name)


@group.command()
def get(
    name: Name,
    out: Annotated[
        Path | None, typer.Option(help="A folder to copy it to; without it nothing is copied.")
    ] = None,
) -> None:
    """Verify a checkpoint by its hash, and print its folder.

    Example: kitchen-prefs evaluate --policy.path=$(kitchen-prefs checkpoints get ttp_quick)
    --split=seen --out=outputs/evaluation
    """
    folder = checkpoints.find_checkpoint(name)
    if out is not None:
        if out.exists():
            raise ValueError(f"{out} exists; give another --out.")
        folder = Path(shutil.copytree(folder, out))
    typer.echo(folder)


@group.command()
def record() -> None:
    """Write the manifest of a clone's checkpoints anew, with the hash of each file.

    Example: kitchen-prefs checkpoints record
    """
    typer.echo(f"The hashes are in {checkpoints.record_checkpoints()}.")

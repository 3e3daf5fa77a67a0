"""The command `kitchen-prefs quickstart`."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from kitchen_prefs.utils.files import make_folder

if TYPE_CHECKING:
    from kitchen_prefs.evaluation.evaluator import Summary
    from kitchen_prefs.metrics import Episode
    from kitchen_prefs_experiments.lerobot_train import TrainingRun

app = typer.Typer()

RECIPE = "ttp_quick"
TRAINING_DATA = "dishwasher-train-v1"
EVALUATED = ("seen", "unseen_preferences")
RULES = ("random", "majority", "expert")
SHOWN = ("unseen_preferences", 21)  # the episode of the pictures: all dishes are there at once


@app.command()
def quickstart(
    out: Annotated[Path, typer.Option(help="The folder of the results.")] = Path(
        "outputs/quickstart"
    ),
) -> None:
    """Make the data, train TTP for some minutes, score it beside simple rules, and draw pictures.

    Finished parts are kept: a command that was stopped resumes with the next part.

    For example:
    kitchen-prefs quickstart
    """
    make_folder(out, "--out")
    typer.echo(f"1/4  Demonstrations: {TRAINING_DATA}")
    from kitchen_prefs.datasets import make_dataset

    make_dataset(TRAINING_DATA)

    typer.echo(f"2/4  Training: lerobot-train with the recipe {RECIPE}")
    from kitchen_prefs_experiments.lerobot_train import TrainingRun

    run = TrainingRun(out / "train")
    _train(run)

    typer.echo("3/4  Rollouts in the kitchen, sessions and preferences that training has not seen")
    summaries, shown = _evaluate(run.checkpoint, out)

    typer.echo("4/4  Table and pictures")
    from kitchen_prefs_experiments.quickstart.report import write_learning_curve, write_table

    typer.echo(f"\n{write_table(summaries, out)}")
    write_learning_curve(run.log_entries(), run.config["log_freq"], out / "learning_curve.png")
    _draw(shown, out)
    typer.echo(f"The table, the learning curve and the pictures are in {out}.")
    typer.echo(_next_steps(run.checkpoint, out))


def _train(run: "TrainingRun") -> None:
    """Train the recipe, unless that is finished; a run that was stopped starts from the beginning.

    If it resumed, its log and thus the learning curve would hold some steps twice.
    """
    if not run.is_finished:
        run.delete()
        run.train(RECIPE)


def _draw(episode: "Episode", out: Path) -> None:
    """Draw the pictures, if MuJoCo and OpenGL are available; nothing else needs them."""
    try:
        from kitchen_prefs_experiments.quickstart.episode_pictures import draw_episode

        draw_episode(episode, out)
    except OSError as error:
        typer.echo(f"There are no pictures of an episode. {error}")


def _evaluate(checkpoint: Path, out: Path) -> tuple[dict[str, dict[str, "Summary"]], "Episode"]:
    """Evaluate every policy on every split; also returns the episode of the pictures."""
    from kitchen_prefs.evaluation.evaluator import Evaluator
    from kitchen_prefs.evaluation.policy_loading import load_policy

    loaded_policies = {"TTP": load_policy(str(checkpoint))}
    for rule in RULES:
        loaded_policies[rule] = load_policy(policy_type="rules", options=[f"--rule={rule}"])
    evaluators = {
        name: Evaluator(loaded_policy, out / "evaluation" / name)
        for name, loaded_policy in loaded_policies.items()
    }
    summaries = {
        name: {split: evaluator.evaluate(split) for split in EVALUATED}
        for name, evaluator in evaluators.items()
    }
    split, session = SHOWN
    return summaries, evaluators["TTP"].episodes(split)[session]


def _next_steps(checkpoint: Path, out: Path) -> str:
    return f"""
Next, on preferences and numbers of dishes that training has not seen; and a longer training:
  kitchen-prefs evaluate --policy.path={checkpoint} \\
    --split=unseen_both --out={out}/unseen_both
  kitchen-prefs train --recipe={RECIPE} --steps=4000 --out=outputs/ttp_longer
"""

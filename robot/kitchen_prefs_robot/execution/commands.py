"""`kitchen-prefs robot run` and `kitchen-prefs robot table`: a policy drives the robot.

MuJoCo, torch and LeRobot are imported inside the commands, so that `--help` does not wait.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table
from tqdm import tqdm

from kitchen_prefs.utils.files import at_work_alone, atomic_folder, make_folder, require_empty
from kitchen_prefs.utils.suggestions import suggest

if TYPE_CHECKING:
    from kitchen_prefs_robot.execution.outcomes import EpisodeOutcome

PolicyPath = Annotated[
    str, typer.Option("--policy.path", help="A checkpoint's folder, or its hub name.")
]
CAUSES = ("perception", "grasp", "decision", "drawer")


def run(
    path: PolicyPath,
    scene: Annotated[int, typer.Option(min=0, help="The seed of the scene.")],
    out: Annotated[Path, typer.Option(help="The folder of the log and the video, which is made.")],
    demonstration: Annotated[
        str | None,
        typer.Option(
            help="A data set of `robot demonstrate`, FOLDER or FOLDER:EPISODE; one is made, of "
            "--preference in another scene, if it is not given."
        ),
    ] = None,
    preference: Annotated[
        int, typer.Option(min=0, max=3, help="What should come of it, and is demonstrated.")
    ] = 0,
    variation: Annotated[
        str, typer.Option(help="What is left to the robot, see `robot table`.")
    ] = "all real",
) -> None:
    """Let a policy load a scene as a person has shown it, and log every decision.

    The robot looks, converts what it sees into the instance set that the policy reads, executes
    the decision, and looks again, until all is put away or the limit is reached.

    Example: kitchen-prefs robot run --policy.path=policies/checkpoints/ttp_drawers --scene=3
    --out=outputs/robot
    """
    from kitchen_prefs.evaluation.policy_loading import load_policy
    from kitchen_prefs_robot.execution.decision_log import DecisionLog
    from kitchen_prefs_robot.execution.prompts import prompt_for, prompt_from
    from kitchen_prefs_robot.execution.trials import VARIATIONS, Trial, run_trial

    _check_variations([variation])
    require_empty(out, "--out")
    make_folder(out.parent, "--out")
    conditions, trial = VARIATIONS[variation], Trial(scene, preference)
    policy = load_policy(path)  # before the demonstration, which takes longer to record
    prompt = (
        prompt_for(scene, preference, conditions)
        if demonstration is None
        else prompt_from(demonstration, preference)
    )
    with at_work_alone(out), atomic_folder(out) as unfinished:
        log = DecisionLog(unfinished)
        outcome = run_trial(policy, trial, conditions, prompt, log)
        log.finish(outcome)
    right = round(outcome.right * outcome.dishes)
    typer.echo(
        f"{right} of {outcome.dishes} dishes right after {outcome.decisions} decisions, "
        f"{outcome.failed_picks} failed picks; {outcome.seconds:.0f} s simulated. See {out}."
    )


def table(
    path: PolicyPath,
    out: Annotated[Path, typer.Option(help="The folder of the outcomes, one file a variation.")],
    scenes: Annotated[int, typer.Option(min=1, help="Each is loaded with each preference.")] = 50,
    preferences: Annotated[int, typer.Option(min=1, max=4, help="How many.")] = 4,
    variation: Annotated[
        list[str] | None, typer.Option(help="Of the rows; may be repeated. All by default.")
    ] = None,
) -> None:
    """Success and causes of failure in many scenes, with real and with perfect parts.

    A row is a variation of what is left to the robot. "Right" is the share of dishes in the right
    drawer in the right order. The command resumes where it was stopped; several commands may work
    on one --out, each on other variations, and another call then shows all in one table.

    Example: kitchen-prefs robot table --policy.path=policies/checkpoints/ttp_drawers --scenes=10
    --out=outputs/robot_table
    """
    from kitchen_prefs.evaluation.policy_loading import load_policy
    from kitchen_prefs_robot.execution.outcome_files import (
        outcome_file,
        read_outcomes,
        write_outcome,
    )
    from kitchen_prefs_robot.execution.trials import VARIATIONS, run_trial, trials

    chosen = variation or list(VARIATIONS)
    _check_variations(chosen)
    make_folder(out, "--out")
    policy = load_policy(path)
    wanted = list(trials(scenes, preferences))
    rows: dict[str, list[EpisodeOutcome]] = {}
    for name in chosen:
        with at_work_alone(outcome_file(out, name)):
            done = read_outcomes(out, name, policy.fingerprint)
            for trial in tqdm([one for one in wanted if one not in done], name, unit="episode"):
                done[trial] = run_trial(policy, trial, VARIATIONS[name])
                write_outcome(out, name, policy.fingerprint, trial, done[trial])
        rows[name] = [done[trial] for trial in wanted]
    Console().print(_as_table(rows))


def _check_variations(names: Sequence[str]) -> None:
    from kitchen_prefs_robot.execution.trials import VARIATIONS

    for name in names:
        if name not in VARIATIONS:
            raise ValueError(f"There is no variation {name!r}. {suggest(name, VARIATIONS)}")


def _as_table(rows: "dict[str, list[EpisodeOutcome]]") -> Table:
    from kitchen_prefs_robot.execution.outcomes import mean_right

    table = Table("variation", "episodes", "right [95 %]", "in drawer", "all", *CAUSES)
    for name, outcomes in rows.items():
        dishes = sum(one.dishes for one in outcomes)
        causes = (sum(one.causes.get(cause, 0) for one in outcomes) for cause in CAUSES)
        table.add_row(
            name,
            str(len(outcomes)),
            str(mean_right(outcomes)),
            f"{sum(one.in_drawer * one.dishes for one in outcomes) / dishes:.3f}",
            f"{sum(one.right == 1 for one in outcomes)}",
            *(str(count) for count in causes),
        )
    return table

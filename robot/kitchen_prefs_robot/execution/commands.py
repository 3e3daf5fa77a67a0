"""`kitchen-prefs robot run` and `kitchen-prefs robot table`: a policy drives the robot.

MuJoCo, torch and LeRobot are imported inside the commands, so that `--help` does not wait.
"""

from collections import Counter
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
    from kitchen_prefs_robot.execution.trials import Trial

PolicyPath = Annotated[
    str, typer.Option("--policy.path", help="A checkpoint's folder, or its hub name.")
]

# Numbers of an outcome that the table sums, and their columns.
COUNTS = {
    "failed_picks": "failed picks",
    "misread": "misread",
    "misread_when_shown": "misread when shown",
}


def run(
    path: PolicyPath,
    scene: Annotated[int, typer.Option(min=0, help="The seed of the scene.")],
    out: Annotated[Path, typer.Option(help="The folder of the log and the video, which is made.")],
    demonstration: Annotated[
        str | None,
        typer.Option(
            help="A data set of `robot demonstrate`, FOLDER or FOLDER:EPISODE, that shows "
            "--preference in another scene; one is made if it is not given."
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
    the decision, and looks again, until all is put away or the limit is reached. A demonstration
    that the cameras do not understand is shown again in another scene, twice at most; the outcome
    says how often it was shown, and how many of its dishes were taken for others.

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
        else prompt_from(demonstration, scene, preference)
    )
    with at_work_alone(out), atomic_folder(out) as unfinished, DecisionLog(unfinished) as log:
        outcome = run_trial(policy, trial, conditions, prompt, log)
        log.finish(outcome)
    right = round(outcome.right * outcome.dishes)
    typer.echo(
        f"{right} of {outcome.dishes} dishes right after {outcome.decisions} decisions, "
        f"{outcome.failed_picks} failed picks; {outcome.seconds:.0f} s simulated. See {out}. "
        f"{outcome.blind}".strip()
    )


def table(
    path: PolicyPath,
    out: Annotated[Path, typer.Option(help="The folder of the outcomes, one file a variation.")],
    scenes: Annotated[int, typer.Option(min=1, help="Each is loaded with each preference.")] = 50,
    first: Annotated[
        int, typer.Option(min=0, help="The seed of the first; settings were chosen on 0 to 49.")
    ] = 1000,
    preferences: Annotated[int, typer.Option(min=1, max=4, help="How many.")] = 4,
    variation: Annotated[
        list[str] | None, typer.Option(help="Of the rows; may be repeated. All by default.")
    ] = None,
) -> None:
    """Success and causes of failure in many scenes, with real and with perfect parts.

    A row is a variation of what is left to the robot. "Right" is the share of dishes in the right
    drawer in the right order, with its 95 % interval over scenes; "whole" are the episodes in which
    all are. A demonstration that is not understood is shown again in another scene, twice at most.
    The command resumes where it was stopped; several commands may work on one --out, each on other
    variations, and another call then shows all in one table.

    Example: kitchen-prefs robot table --policy.path=policies/checkpoints/ttp_drawers --scenes=10
    --out=outputs/robot_table
    """
    from kitchen_prefs.evaluation.policy_loading import load_policy
    from kitchen_prefs_robot.execution.outcome_files import OutcomeFile
    from kitchen_prefs_robot.execution.trials import VARIATIONS, run_trial, trials

    chosen = variation or list(VARIATIONS)
    _check_variations(chosen)
    make_folder(out, "--out")
    policy = load_policy(path)
    wanted = list(trials(range(first, first + scenes), preferences))
    rows: dict[str, dict[Trial, EpisodeOutcome]] = {}
    for name in chosen:
        file = OutcomeFile(out, name, policy.fingerprint)
        with at_work_alone(file.path):
            done = file.read()
            for trial in tqdm([one for one in wanted if one not in done], name, unit="episode"):
                done[trial] = run_trial(policy, trial, file.conditions)
                file.add(trial, done[trial])
        rows[name] = {trial: done[trial] for trial in wanted}
    Console().print(_as_table(rows))


def _check_variations(names: Sequence[str]) -> None:
    from kitchen_prefs_robot.execution.trials import VARIATIONS

    for name in names:
        if name not in VARIATIONS:
            raise ValueError(f"There is no variation {name!r}. {suggest(name, VARIATIONS)}")


def _as_table(rows: "dict[str, dict[Trial, EpisodeOutcome]]") -> Table:
    from kitchen_prefs_robot.execution.trials import mean_right

    table = Table("variation", "right [95 %]", "in drawer", "whole", *COUNTS.values(), "failed by")
    for name, of_trial in rows.items():
        outcomes = list(of_trial.values())
        dishes = sum(one.dishes for one in outcomes)
        table.add_row(
            name,
            str(mean_right(of_trial)),
            f"{sum(one.in_drawer * one.dishes for one in outcomes) / dishes:.3f}",
            f"{sum(one.right == 1 for one in outcomes)} of {len(outcomes)}",
            *(str(sum(getattr(one, count) for one in outcomes)) for count in COUNTS),
            _in_words(sum((Counter(one.causes) for one in outcomes), Counter())),
        )
    return table


def _in_words(causes: Counter[str]) -> str:
    """What dishes failed by, the most frequent first."""
    return ", ".join(f"{count} {cause}" for cause, count in causes.most_common())

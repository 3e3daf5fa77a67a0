"""`kitchen-prefs leaderboard`: submit, score, verify, show, push.

LeRobot and torch take seconds to import, so the commands import what needs them when they run.
"""

import os
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from kitchen_prefs.evaluation.policy_options import ANY_SETTING, PolicyPath, PolicyType
from kitchen_prefs.evaluation.tiers import TIERS
from kitchen_prefs.utils.files import at_work_alone, make_folder
from kitchen_prefs_leaderboard.submission_format import UNSPECIFIED

if TYPE_CHECKING:
    from kitchen_prefs_leaderboard.scoring import Entry

app = typer.Typer(
    name="leaderboard",
    help="Submissions without scores: make one, score it, verify it, show it, push it.",
    no_args_is_help=True,
)
console = Console()

Jobs = Annotated[int, typer.Option(help="The number of processes, one per core.", min=1)]
CORES = os.cpu_count() or 1
Verifications = Annotated[Path, typer.Option(help="The records of re-runs.")]
KEPT = Path("leaderboard/verifications")


class Form(StrEnum):
    """How scores are printed."""

    TABLE = "table"
    JSON = "json"
    CSV = "csv"


class Tiers(StrEnum):
    """The tiers whose test splits a submission covers."""

    PREFERENCES = "preferences"
    PEOPLE = "people"


class Groups(StrEnum):
    """What scores are broken down by."""

    PREFERENCE = "preference"
    COUNT = "count"


@app.command(context_settings=ANY_SETTING)
def submit(
    context: typer.Context,
    name: Annotated[str, typer.Option(help="The name of the entry.")],
    track: Annotated[str, typer.Option(help="standard, privileged, language or open.")],
    out: Annotated[Path, typer.Option(help="The submission's folder.")],
    tier: Annotated[list[Tiers], typer.Option(help="What it covers; several.")] = [  # noqa: B006
        Tiers.PREFERENCES
    ],
    path: PolicyPath = None,
    policy_type: PolicyType = None,
    author: Annotated[list[str], typer.Option(help="Who submits; several.")] = ["anonymous"],  # noqa: B006
    link: Annotated[str | None, typer.Option(help="Where to read more.")] = None,
    hardware: Annotated[str, typer.Option(help="The hardware of the training.")] = UNSPECIFIED,
    training: Annotated[
        str | None,
        typer.Option(
            help="The data and the number of steps.", show_default="from train_config.json"
        ),
    ] = None,
    recordings: Annotated[
        Path | None,
        typer.Option("--from", help="Recordings of lerobot-eval, instead of rolling out."),
    ] = None,
    jobs: Jobs = CORES,
) -> None:
    """Roll a policy out on the test splits and write its actions as a submission.

    The test splits are those of the first tier, unless --tier=people asks for those of the second
    or both --tier=preferences --tier=people for those of both.
    The episodes are kept in OUT-episodes, so a command that was killed resumes.
    Any other --policy.SETTING=VALUE overrides a setting of the policy.
    With --from=DIR the actions are those that `lerobot-eval --env.type=kitchen_prefs
    --env.task=SPLIT --eval.recording=true --output_dir=DIR/SPLIT` recorded on each test split.

    For example:
    kitchen-prefs leaderboard submit --name="My TTP" --track=standard --out=outputs/my_ttp
    --policy.path=outputs/ttp_quick/checkpoints/last/pretrained_model
    """
    make_folder(out.parent, "--out")
    from kitchen_prefs_leaderboard import submission_writing
    from kitchen_prefs_leaderboard.policy_runs import load_policy_run

    submission_writing.check_replaceable(out)
    tiers = [one for name, one in TIERS.items() if name in tier]
    policy = load_policy_run(path, policy_type, context.args, track, tiers)
    submission = submission_writing.describe(
        tiers,
        name=name,
        authors=author,
        link=link,
        track=track,
        policy=submission_writing.policy_of(policy.loaded_policy),
        hardware=hardware,
        training=training or (submission_writing.training_of(path) if path else UNSPECIFIED),
    )
    with at_work_alone(out):
        if recordings:
            from kitchen_prefs_leaderboard.recording_reading import read_recordings

            episodes = read_recordings(recordings, policy.splits)
        else:
            episodes = policy.roll_out(out.with_name(f"{out.name}-episodes"), salt=0, jobs=jobs)
        submission_writing.write_submission(submission, episodes, out)
    typer.echo(f"The submission is {out}. `kitchen-prefs leaderboard score {out}` scores it.")


@app.command()
def score(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR", help="Submissions.")],
    form: Annotated[Form, typer.Option("--format", help="How to print.")] = Form.TABLE,
    by: Annotated[Groups | None, typer.Option(help="Break down.", show_default="not")] = None,
    jobs: Jobs = CORES,
) -> None:
    """Replay every action of submissions and print every metric.

    For example:
    kitchen-prefs leaderboard score outputs/my_ttp
    kitchen-prefs leaderboard score leaderboard/submissions/* --format=csv --by=count
    """
    from kitchen_prefs_leaderboard import score_formats

    entries = _scored(folders, jobs)
    if form is Form.TABLE:
        for entry in entries:
            console.print(*score_formats.to_tables(entry, by), sep="\n")
        return
    write = score_formats.to_json if form is Form.JSON else score_formats.to_csv
    typer.echo(write(entries, by), nl=False)


@app.command(context_settings=ANY_SETTING)
def verify(
    context: typer.Context,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A submission.")],
    rerun: Annotated[bool, typer.Option("--rerun", help="Roll the policy out again.")] = False,
    path: PolicyPath = None,
    policy_type: PolicyType = None,
    salt: Annotated[
        int | None,
        typer.Option(help="The seed of the fresh sessions.", min=1, show_default="at random"),
    ] = None,
    by: Annotated[str, typer.Option(help="Who re-runs it.")] = "unknown",
    plugins: Annotated[
        Path | None,
        typer.Option(
            help="The folder of the policy's package, for `pip install --target`.",
            show_default="none",
            file_okay=False,
            exists=True,
        ),
    ] = None,
    verifications: Verifications = KEPT,
    out: Annotated[Path, typer.Option(help="The folder of the episodes.")] = Path("outputs/verify"),
    jobs: Jobs = CORES,
) -> None:
    """Replay a submission's actions; with --rerun, check which policy chose them.

    A re-run rolls the policy out again, on the test splits and on fresh sessions of fresh users,
    which were not known when the submission was made. The policy runs in a process of its own that
    receives observations alone. The record is kept; only rows with one are ranked.
    A command that was killed resumes. A stranger's package belongs into a folder of its own,
    --plugins, from which that process alone imports.

    For example:
    kitchen-prefs leaderboard verify leaderboard/submissions/ttp_plus --rerun
    --policy.path=policies/checkpoints/ttp_plus
    """
    from kitchen_prefs_leaderboard import score_formats, verification
    from kitchen_prefs_leaderboard.scoring import read_known, replay_submissions

    if not rerun:
        if path or policy_type or plugins or context.args:
            raise ValueError("A policy is rolled out again with --rerun only; add it.")
        replay_submissions([read_known(folder)], jobs)
        typer.echo(f"All actions of {folder} lead to the states that it names.")
        typer.echo("Only a re-run shows which policy chose them: add --rerun and the policy.")
        return
    make_folder(out, "--out")
    make_folder(verifications, "--verifications")
    from kitchen_prefs.evaluation.isolation.sandbox import warn_without_sandbox
    from kitchen_prefs_leaderboard.policy_runs import settings_on_track
    from kitchen_prefs_leaderboard.reruns import Rerunner, rerun_submission
    from kitchen_prefs_leaderboard.submission_writing import policy_of

    warn_without_sandbox()
    submission = read_known(folder)
    about, confirmed = submission.description, True
    for tier in about.tiers:
        settings = settings_on_track(path, policy_type, context.args, about.track, tier)
        kept = out / submission.digest(tier)[:12]
        rerunner = Rerunner(settings, kept, jobs, plugins, tier=tier)
        with at_work_alone(kept):
            verification.check_policy(about, policy_of(rerunner.described, plugins))
            (entry,) = replay_submissions([submission], jobs, tier)
            found = rerun_submission(entry, rerunner, salt, by)
        file = verification.write_verification(found, verifications)
        console.print(score_formats.to_comparison(found, tier))
        typer.echo(f"{score_formats.to_verdict(found)}\nThe record is {file}.")
        confirmed &= found.confirmed
    if not confirmed:
        raise typer.Exit(1)


@app.command()
def page(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR", help="Submissions.")],
    out: Annotated[Path, typer.Option(help="The HTML file.")],
    verifications: Verifications = KEPT,
    jobs: Jobs = CORES,
) -> None:
    """Replay submissions and show them in one HTML file that needs no network.

    For example:
    kitchen-prefs leaderboard page leaderboard/submissions/* --out=outputs/leaderboard.html
    """
    if out.is_dir():
        raise ValueError(f"{out} is a folder; give --out a file in it.")
    make_folder(out.parent, "--out")
    from kitchen_prefs_leaderboard.page.building import write_page
    from kitchen_prefs_leaderboard.ranking import rank_tiers
    from kitchen_prefs_leaderboard.verification import read_verifications

    if verifications != KEPT and not verifications.is_dir():
        raise ValueError(f"There is no folder {verifications}; give another --verifications.")
    verified = read_verifications(verifications)
    write_page(rank_tiers(_scored(folders, jobs), verified), out)
    typer.echo(f"The page is {out}; a browser opens it without a server.")


def _scored(folders: list[Path], jobs: int) -> "list[Entry]":
    """Replay and score submissions, and say which are of one checkpoint."""
    from kitchen_prefs_leaderboard.scoring import score_submissions, shared_checkpoints

    entries = score_submissions(folders, jobs)
    for sentence in shared_checkpoints(entries):
        typer.echo(sentence, err=True)
    return entries


@app.command()
def push(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A submission.")],
    repo_id: Annotated[
        str, typer.Option(help="The leaderboard's data set repository, OWNER/NAME.")
    ],
    name: Annotated[
        str | None, typer.Option(help="Its folder there.", show_default="DIR's name")
    ] = None,
) -> None:
    """Propose a submission to a leaderboard on the Hugging Face hub, as a pull request.

    It is read as `score` reads it, but not replayed: it is scored before it is merged.
    Log in with `hf auth login`, or put a token into HF_TOKEN.

    For example:
    kitchen-prefs leaderboard push outputs/my_ttp --repo-id=OWNER/NAME
    """
    from kitchen_prefs_leaderboard.hub_upload import push_submission

    address = push_submission(folder, repo_id, name or folder.resolve().name)
    typer.echo(f"The pull request is {address}.")


@app.command()
def push_page(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="What `page` wrote.")],
    repo_id: Annotated[str, typer.Option(help="The Space, OWNER/SPACE.")],
) -> None:
    """Show the page as a static Space of the Hugging Face hub.

    Log in with `hf auth login`, or put a token into HF_TOKEN.

    For example:
    kitchen-prefs leaderboard push-page outputs/leaderboard.html --repo-id=OWNER/SPACE
    """
    from kitchen_prefs_leaderboard import hub_upload

    typer.echo(f"The page is shown at {hub_upload.push_page(file, repo_id)}.")

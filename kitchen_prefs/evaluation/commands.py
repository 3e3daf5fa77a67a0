"""`kitchen-prefs evaluate` and `kitchen-prefs select`.

LeRobot and torch take many seconds to import, so the commands import what needs them when they run;
`--help` stays quick.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

from kitchen_prefs.datasets.prompt_reading import read_prompt
from kitchen_prefs.evaluation.policy_options import (
    ANY_SETTING,
    PolicyPath,
    PolicyType,
    settings_of,
)
from kitchen_prefs.evaluation.tiers import PREFERENCES, Tier, tier_of
from kitchen_prefs.metrics import Interval
from kitchen_prefs.utils.files import at_work_alone, make_folder

if TYPE_CHECKING:
    from kitchen_prefs.evaluation.evaluator import Summary
    from kitchen_prefs.evaluation.isolation.isolated_policy import IsolatedPolicy
    from kitchen_prefs.evaluation.policy_loading import LoadedPolicy

app = typer.Typer()
console = Console()

Track = Annotated[
    str | None,
    typer.Option(
        help="What the policy observes: standard, privileged or language.",
        show_default="as the policy asks",
    ),
]
BatchSize = Annotated[int, typer.Option(help="How many sessions are rolled out at once.", min=1)]


@app.command(context_settings=ANY_SETTING)
def evaluate(
    context: typer.Context,
    split: Annotated[list[str], typer.Option(help="A split; several, or a list with commas.")],
    out: Annotated[Path, typer.Option(help="The folder of the episodes.")],
    path: PolicyPath = None,
    policy_type: PolicyType = None,
    track: Track = None,
    salt: Annotated[
        int,
        typer.Option(help="The session seed; 0: the published sessions.", min=0),
    ] = 0,
    prompts: Annotated[
        int, typer.Option(help="How many demonstrations prompt an episode.", min=1)
    ] = 1,
    prompt: Annotated[
        str | None,
        typer.Option(
            help="A demonstration that prompts every episode, NAME or NAME:EPISODE of a data set.",
            show_default="the benchmark's prompts",
        ),
    ] = None,
    batch_size: BatchSize = 16,
    prompt_use: Annotated[
        bool, typer.Option("--prompt-use", help="Also roll out with another preference's prompt.")
    ] = False,
    category_accuracy: Annotated[
        bool, typer.Option("--category-accuracy", help="Also evaluate on the expert's states.")
    ] = False,
    untrusted: Annotated[
        bool,
        typer.Option("--untrusted", help="Confine the policy to a process of its own."),
    ] = False,
) -> None:
    """Roll a policy out on splits and print its metrics and failure modes.

    OUT holds one line per episode, so a command that was killed resumes.
    Any other --policy.SETTING=VALUE overrides a setting of the policy.
    Splits of both tiers have tables of their own: people_val, people_unseen and others are those
    of the second.
    With --untrusted the policy receives observations through a pipe and sees nothing else, as in
    re-runs of the leaderboard.

    For example:
    kitchen-prefs evaluate --split=seen,unseen_counts --out=outputs/ttp
    --policy.path=outputs/ttp_quick/checkpoints/last/pretrained_model

    A policy that needs no training:
    kitchen-prefs evaluate --split=seen --out=outputs/symbolic
    --policy.type=rules --policy.rule=symbolic

    With --prompt every user of the split has the preference that the demonstration follows, which
    its data set has as a label, and the expert of that preference is the yardstick:
    kitchen-prefs evaluate --split=seen --out=outputs/mine --prompt=my_kitchen:0
    --policy.path=policies/checkpoints/ttp_plus
    """
    names = _names(split)
    tiers = list(dict.fromkeys(map(tier_of, names)))
    settings = settings_of(context.args)
    if prompt and (prompt_use or prompts > 1):
        raise ValueError("--prompt gives the only prompt; leave out --prompts and --prompt-use.")
    given = read_prompt(prompt) if prompt else None
    for tier in tiers:
        tier.check(
            track=track or "standard",
            prompt_of="other" if prompt_use else "same",
            prompts=prompts,
            given=given,
            expert_states=category_accuracy,
        )
    make_folder(out, "--out")
    from kitchen_prefs.evaluation.evaluator import Evaluator
    from kitchen_prefs.evaluation.isolation.policy_settings import policy_settings

    for tier in tiers:
        arguments = policy_settings(path, policy_type, settings, track, tier.val)
        with _loaded(arguments, out, untrusted) as policy:
            evaluator = Evaluator(policy, out, salt, prompts, given, batch_size)
            own = [name for name in names if name in tier.splits]
            summaries = []
            for name in own:
                with at_work_alone(out / name):
                    summary = evaluator.evaluate(
                        name, with_prompt_use=prompt_use, with_category_accuracy=category_accuracy
                    )
                _print_summary(summary)
                summaries.append(summary)
            if len(own) > 1:
                _print_overview(tier, summaries, evaluator.mean_of_splits(own))
    console.print(f"Episodes and summaries are in {out}.")


@contextmanager
def _loaded(
    arguments: dict[str, Any], out: Path, untrusted: bool
) -> "Iterator[LoadedPolicy | IsolatedPolicy]":
    """The policy that `load_policy` makes of some arguments, in a process of its own if asked."""
    if untrusted:
        from kitchen_prefs.evaluation.isolation.isolated_policy import IsolatedPolicy
        from kitchen_prefs.evaluation.isolation.sandbox import warn_without_sandbox

        warn_without_sandbox()
        with IsolatedPolicy(arguments, out / "policy.log", hidden=[out]) as policy:
            yield policy
    else:
        from kitchen_prefs.evaluation.policy_loading import load_policy

        yield load_policy(**arguments)


@app.command()
def select(
    run: Annotated[Path, typer.Argument(help="The output folder of lerobot-train or `reinforce`.")],
    track: Track = None,
    split: Annotated[
        str, typer.Option(help="val, or people_val for a policy of the second tier.")
    ] = PREFERENCES.val,
    batch_size: BatchSize = 16,
) -> None:
    """Evaluate a run's saved checkpoints on val and name the one with the best headline.

    Writes RUN/selection.json; a command that was killed resumes. The headline is Score, or H of
    the second tier.

    For example:
    kitchen-prefs select outputs/ttp_quick
    kitchen-prefs select outputs/ttp_people --split=people_val
    """
    from kitchen_prefs.evaluation.checkpoint_selection import select_checkpoint

    selection = select_checkpoint(run, split=split, track=track, batch_size=batch_size)
    tier = tier_of(split)
    columns = tier.tables[0]
    table = Table("Step", *columns, title=split)
    for step, metrics in selection.metrics.items():
        _add_intervals(table, step, metrics, columns)
    console.print(table)
    console.print(f"The best by {tier.headline} is {selection.best}.")


def _names(splits: Sequence[str]) -> list[str]:
    return list(dict.fromkeys(name.strip() for text in splits for name in text.split(",")))


def _print_summary(summary: "Summary") -> None:
    title = f"{summary.split}, {summary.episodes} episodes"
    metrics = Table("Metric", "Mean", "95 % interval", title=title)
    for name, interval in summary.metrics.items():
        metrics.add_row(name, f"{interval.mean:.3f}", f"{interval.low:.3f} to {interval.high:.3f}")
    console.print(metrics)
    console.print(f"Success with its Wilson interval is {summary.wilson_success}.")
    tier = tier_of(summary.split)
    references = tier.references().get(summary.split)
    if references and "Rescaled" in summary.metrics:
        console.print(
            f"Rescaled is 0 at the {tier.headline} {references['floor']:.3f} (the rule "
            f"{tier.floor}) and 1 at {references['ceiling']:.3f} (the rule {tier.ceiling})."
        )
    modes = Table("Failure mode", "Episodes", "Times")
    for mode, (episodes, times) in summary.failure_modes.items():
        if times:
            modes.add_row(mode, str(episodes), str(times))
    if modes.row_count:
        console.print(modes)


def _print_overview(tier: Tier, summaries: Sequence["Summary"], mean: dict[str, Interval]) -> None:
    for names in tier.tables:
        table = Table("Split", *names, title="Means")
        for summary in summaries:
            _add_intervals(table, summary.split, summary.metrics, names)
        _add_intervals(table, "mean of the splits", mean, names)
        console.print(table)


def _add_intervals(
    table: Table, name: str, metrics: dict[str, Interval], names: Sequence[str]
) -> None:
    """Add three rows: intervals side by side would be wider than a terminal."""
    intervals = [metrics.get(metric) for metric in names]
    for head, end in ((name, "mean"), ("  95 % from", "low"), ("         to", "high")):
        table.add_row(head, *(f"{getattr(i, end):.3f}" if i else "-" for i in intervals))
    table.add_section()

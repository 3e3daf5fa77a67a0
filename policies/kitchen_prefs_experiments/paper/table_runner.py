"""Runs a table: its trainings, its evaluations, and the metrics of every row."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from filelock import FileLock
from tqdm import tqdm

from kitchen_prefs.utils.processes import run_module
from kitchen_prefs_experiments.paper.evaluated_policies import Policy
from kitchen_prefs_experiments.paper.prepared_policies import PreparedPolicy, check, prepare
from kitchen_prefs_experiments.paper.result_files import PolicyResults, PolicyRow
from kitchen_prefs_experiments.paper.table_metrics import measure_groups
from kitchen_prefs_experiments.paper.table_types import Table


def run_table(name: str, table: Table, budget: int, jobs: int, out: Path) -> PolicyResults:
    """Train and evaluate a table's policies; finished work is reused.

    Args:
        name: The table's name.
        table: Its policies, splits and metrics.
        budget: The number of decisions in each training.
        jobs: The number of policies trained or evaluated at once, each in a thread.
        out: The folder of the runs and the episodes.

    Raises:
        ValueError: If a checkpoint is missing, or if `out` holds runs with other settings.
        OSError: If a training or an evaluation fails; the message names its log.
    """
    for policy in table.policies:
        check(policy, budget)
    with ThreadPoolExecutor(jobs) as pool:
        rows = pool.map(lambda policy: _row(policy, table, budget, out), table.policies)
        bar = tqdm(rows, name, len(table.policies), unit="policy")
        by_policy = dict(zip(table.policies, bar, strict=True))
    return PolicyResults.of_this_version(
        name,
        {label: by_policy[policy] for label, policy in table.rows.items()},
        table.recipes if table.trains else None,
        budget if table.trains else None,
    )


def _row(policy: Policy, table: Table, budget: int, out: Path) -> PolicyRow:
    """Prepare and evaluate a policy, and measure it in each group of a table."""
    prepared = prepare(policy, budget, out)
    for one in prepared:
        _evaluate(one, table, policy.name)
    groups = measure_groups(table, prepared)
    descriptions = [one.description for one in prepared]
    if len(descriptions) > 1:
        return PolicyRow(policies=descriptions, groups=groups)
    return PolicyRow(**dict(descriptions[0]), groups=groups)


def _evaluate(policy: PreparedPolicy, table: Table, name: str) -> None:
    """Roll out the missing episodes.

    Tables share policies: a second thread waits until the first has finished one.
    """
    policy.folder.mkdir(parents=True, exist_ok=True)
    common = ["evaluate", *policy.options, f"--out={policy.episodes}"]
    if table.needs_expert_states:
        common.append("--category-accuracy")
    others = [split for split in table.splits if split not in table.prompt_use]
    for splits, options in ((table.prompt_use, ["--prompt-use"]), (others, [])):
        if splits:
            arguments = [*common, f"--split={','.join(splits)}", *options]
            with FileLock(policy.folder / "evaluate.lock"):
                run_module("kitchen_prefs.cli", arguments, policy.folder / "evaluate.log", name)

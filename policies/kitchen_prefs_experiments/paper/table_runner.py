"""All that a table needs: trainings, evaluations, and the facts that come of them."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from filelock import FileLock
from tqdm import tqdm

from kitchen_prefs.utils.processes import run_module
from kitchen_prefs_experiments.paper.evaluated_policies import Policy
from kitchen_prefs_experiments.paper.prepared_policies import Player, players_of, prepare
from kitchen_prefs_experiments.paper.result_files import make_facts
from kitchen_prefs_experiments.paper.table_metrics import measure_groups
from kitchen_prefs_experiments.paper.table_types import Table


def run_table(name: str, table: Table, budget: int, jobs: int, out: Path) -> dict:
    """Train and evaluate what a table needs and is not there yet.

    Args:
        name: The table's name.
        table: What it holds.
        budget: How many decisions each training sees.
        jobs: How many policies are trained or evaluated at once, each in a thread.
        out: Keeps the runs and the episodes.

    Returns:
        The facts, as `facts` keeps them.

    Raises:
        ValueError: If a checkpoint is not there, or if `out` holds another policy's work.
        OSError: If a training or an evaluation fails; the message names its log.
    """
    policies = table.policies
    for policy in policies:
        prepare(policy, budget)
    with ThreadPoolExecutor(jobs) as pool:
        facts = pool.map(lambda policy: _evaluated(policy, table, budget, out), policies)
        of_policy = dict(
            zip(policies, tqdm(facts, name, len(policies), unit="policy"), strict=True)
        )
    rows = {label: of_policy[policy] for label, policy in table.rows.items()}
    conditions = {"recipes": table.recipes, "budget": budget} if table.trains else {}
    return make_facts(name, rows, conditions)


def _evaluated(policy: Policy, table: Table, budget: int, out: Path) -> dict:
    """What a policy is, and its metrics in each group of a table."""
    players = players_of(policy, budget, out)
    for player in players:
        _play(player, table, policy.name)
    each = [player.facts for player in players]
    facts = each[0] if len(each) == 1 else {"policies": each}
    return facts | {"groups": measure_groups(table, players)}


def _play(player: Player, table: Table, name: str) -> None:
    """Play the episodes that are not there yet.

    Tables share players, so whoever asks for one that is being played waits for it.
    """
    player.folder.mkdir(parents=True, exist_ok=True)
    common = ["evaluate", *player.source, f"--out={player.episodes}"]
    if table.asks_for_accuracy:
        common.append("--category-accuracy")
    others = [split for split in table.splits if split not in table.prompt_use]
    for splits, options in ((table.prompt_use, ["--prompt-use"]), (others, [])):
        if splits:
            arguments = [*common, f"--split={','.join(splits)}", *options]
            with FileLock(player.folder / "evaluate.lock"):
                run_module("kitchen_prefs.cli", arguments, player.folder / "evaluate.log", name)

"""All that a table needs: trainings, evaluations, and the facts that come of them."""

import json
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from importlib.metadata import version
from itertools import chain
from pathlib import Path

from tqdm import tqdm

from kitchen_prefs.datasets import make_dataset
from kitchen_prefs.metrics import METRICS, Episode, summarise
from kitchen_prefs.records import read_episodes
from kitchen_prefs.reproduction.policies import RECIPE, Committed, Policy, Rule, Training, numbered
from kitchen_prefs.reproduction.processes import run_module
from kitchen_prefs.reproduction.tables import Table
from kitchen_prefs.reproduction.training import seconds_of, train
from kitchen_prefs.splits import DATA_VERSION


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
        _prepare(policy, budget)
    with ThreadPoolExecutor(jobs) as pool:
        facts = pool.map(lambda policy: _evaluated(policy, table, budget, out), policies)
        of_policy = dict(
            zip(policies, tqdm(facts, name, len(policies), unit="policy"), strict=True)
        )
    return {
        "table": name,
        "data_version": DATA_VERSION,
        "package_version": version("lerobot_policy_kitchen_prefs"),
        **({"recipe": RECIPE, "budget": budget} if table.trains else {}),
        "rows": {label: of_policy[policy] for label, policy in table.rows.items()},
    }


def _prepare(policy: Policy, budget: int) -> None:
    """Make the data, find the checkpoint: what is missing is said before hours of work."""
    match policy:
        case Training():
            policy.steps(budget)
            make_dataset(policy.dataset)
        case Committed():
            policy.find()


def _evaluated(policy: Policy, table: Table, budget: int, out: Path) -> dict:
    """What a policy is, and its metrics in each group of a table."""
    match policy:
        case Training():
            folder = out / str(budget) / policy.name
            source = [f"--policy.path={train(policy, budget, folder)}"]
            seconds = seconds_of(policy, budget, folder)
            facts: dict = {"options": policy.options(budget), "seconds": seconds}
        case Committed():
            folder = out / "checkpoints" / numbered(policy.name, policy.prompts)
            source = [f"--policy.path={policy.find()}", f"--prompts={policy.prompts}"]
            facts = {"checkpoint": policy.name}
        case Rule():
            folder = out / "rules" / numbered(policy.name, policy.prompts)
            source = ["--policy.type=rules", f"--policy.rule={policy.name}"]
            source.append(f"--prompts={policy.prompts}")
            facts = {"rule": policy.name}
    _evaluate(policy.name, source, table, folder)
    return facts | {"groups": _groups(table, folder / "evaluation")}


def _evaluate(name: str, source: list[str], table: Table, folder: Path) -> None:
    """Play the episodes that are not there yet."""
    folder.mkdir(parents=True, exist_ok=True)
    common = ["evaluate", *source, f"--out={folder / 'evaluation'}"]
    if "Category accuracy" in table.metrics:
        common.append("--category-accuracy")
    others = [split for split in table.splits if split not in table.prompt_use]
    for splits, options in ((table.prompt_use, ["--prompt-use"]), (others, [])):
        if splits:
            arguments = [*common, f"--split={','.join(splits)}", *options]
            run_module("kitchen_prefs.cli", arguments, folder / "evaluate.log", name)


def _groups(table: Table, folder: Path) -> dict[str, dict]:
    """Each group's number of episodes and its metrics, from what an evaluation wrote."""
    groups = {}
    if table.by_count:
        files = [folder / f"{split}.jsonl" for split in table.splits]
        episodes = list(chain.from_iterable(map(read_episodes, files)))
        for count in table.counts:
            groups[str(count)] = _group([e for e in episodes if e.count == count])
    for split in table.splits:
        summary = json.loads((folder / f"{split}.json").read_text())
        groups[split] = {
            "episodes": summary["episodes"],
            "metrics": {name: _rounded(of) for name, of in summary["metrics"].items()},
        }
    return groups


def _group(episodes: Sequence[Episode]) -> dict:
    intervals = {name: asdict(summarise(episodes, metric)) for name, metric in METRICS.items()}
    return {
        "episodes": len(episodes),
        "metrics": {name: _rounded(interval) for name, interval in intervals.items()},
    }


def _rounded(interval: dict[str, float]) -> dict[str, float]:
    """The bootstrap tells no more than three digits; a fourth keeps rounding out of them."""
    return {name: round(value, 4) for name, value in interval.items()}

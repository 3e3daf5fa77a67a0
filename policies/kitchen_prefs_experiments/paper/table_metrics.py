"""The metrics of a table's groups, from the episode files of the evaluations."""

from collections.abc import Iterator, Sequence
from itertools import chain
from statistics import mean

from kitchen_prefs.evaluation.episode_files import read_episodes
from kitchen_prefs.metrics import (
    METRICS,
    Episode,
    Interval,
    category_accuracy,
    packing_efficiency,
    prompt_use,
    summarise,
)
from kitchen_prefs_experiments.paper.prepared_policies import PreparedPolicy
from kitchen_prefs_experiments.paper.result_files import GroupResults
from kitchen_prefs_experiments.paper.table_types import Table

PLACES = ("in top", "in bottom", "in sink")  # the kinds of place decisions


def measure_groups(table: Table, policies: Sequence[PreparedPolicy]) -> dict[str, GroupResults]:
    """Each group's number of episodes and its metrics.

    Args:
        table: The table with the groups.
        policies: The evaluated policies of a row.

    Raises:
        ValueError: If a line is not an episode.
    """
    groups = {}
    by_split = {split: _episodes(policies, split) for split in table.splits}
    all_episodes = list(chain.from_iterable(by_split.values()))
    for count in table.counts:
        of_count = [episode for episode in all_episodes if episode.count == count]
        groups[str(count)] = _group(of_count, _rollout_metrics(of_count))
    for split, episodes in by_split.items():
        groups[split] = _group(episodes, _split_metrics(table, split, episodes, policies))
    return groups


def pick_accuracy(episode: Episode) -> float:
    """`category_accuracy` over the pick decisions alone (paper, appendix on context history).

    Args:
        episode: An episode that was rolled out on the expert's states.
    """
    pairs = zip(episode.kinds, episode.expert_kinds, strict=True)
    return mean(float(kind == expert) for kind, expert in pairs if expert not in PLACES)


def _episodes(policies: Sequence[PreparedPolicy], name: str) -> list[Episode]:
    """The episodes that count, in the order of the sessions, on which the bootstrap depends."""
    counted = [
        episode
        for policy in policies
        for episode in read_episodes(policy.episodes / f"{name}.jsonl")
        if policy.preference in (None, episode.preference)
    ]
    return sorted(counted, key=lambda episode: episode.session)


def _split_metrics(
    table: Table, split: str, episodes: Sequence[Episode], policies: Sequence[PreparedPolicy]
) -> Iterator[tuple[str, Interval]]:
    """All metrics of a split that a table needs; `Evaluator` names the files."""
    yield from _rollout_metrics(episodes)
    if split in table.prompt_use:
        swapped = _episodes(policies, f"{split}-other-prompt")
        yield "PE, other prompt", summarise(swapped, packing_efficiency)
        yield "Prompt use", prompt_use(episodes, swapped)
    if table.needs_expert_states:
        on_expert_states = _episodes(policies, f"{split}-expert-states")
        yield "Category accuracy", summarise(on_expert_states, category_accuracy)
        yield "Pick accuracy", summarise(on_expert_states, pick_accuracy)


def _rollout_metrics(episodes: Sequence[Episode]) -> Iterator[tuple[str, Interval]]:
    for name, metric in METRICS.items():
        yield name, summarise(episodes, metric)


def _group(episodes: Sequence[Episode], metrics: Iterator[tuple[str, Interval]]) -> GroupResults:
    return GroupResults(
        episodes=len(episodes), metrics={name: interval.rounded() for name, interval in metrics}
    )

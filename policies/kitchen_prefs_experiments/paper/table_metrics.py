"""The metrics of a table's groups, from the lines that evaluations wrote."""

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
from kitchen_prefs_experiments.paper.prepared_policies import Player
from kitchen_prefs_experiments.paper.table_types import Table

PLACES = ("in top", "in bottom", "in sink")  # what a place decision chooses among


def measure_groups(table: Table, players: Sequence[Player]) -> dict[str, dict]:
    """Each group's number of episodes and its metrics.

    Args:
        table: Names the groups.
        players: Those that were evaluated, each on the sessions that it is measured on.

    Raises:
        ValueError: If a line is not an episode.
    """
    groups = {}
    of_split = {split: _episodes(players, split) for split in table.splits}
    everything = list(chain.from_iterable(of_split.values()))
    for count in table.counts:
        of_count = [episode for episode in everything if episode.count == count]
        groups[str(count)] = _group(of_count, _of_rollouts(of_count))
    for split, episodes in of_split.items():
        groups[split] = _group(episodes, _of_split(table, split, episodes, players))
    return groups


def pick_accuracy(episode: Episode) -> float:
    """`category_accuracy` over the pick decisions alone (paper, appendix on context history).

    Args:
        episode: An episode that was rolled out on the expert's states.
    """
    pairs = zip(episode.kinds, episode.expert_kinds, strict=True)
    return mean(float(kind == expert) for kind, expert in pairs if expert not in PLACES)


def _episodes(players: Sequence[Player], name: str) -> list[Episode]:
    """The episodes that count, in the order of the sessions, on which the bootstrap depends."""
    counted = [
        episode
        for player in players
        for episode in read_episodes(player.episodes / f"{name}.jsonl")
        if player.preference in (None, episode.preference)
    ]
    return sorted(counted, key=lambda episode: episode.session)


def _of_split(
    table: Table, split: str, episodes: Sequence[Episode], players: Sequence[Player]
) -> Iterator[tuple[str, Interval]]:
    """All metrics of a split that a table asks for; `Evaluator` names the files."""
    yield from _of_rollouts(episodes)
    if split in table.prompt_use:
        swapped = _episodes(players, f"{split}-other-prompt")
        yield "PE, other prompt", summarise(swapped, packing_efficiency)
        yield "Prompt use", prompt_use(episodes, swapped)
    if table.asks_for_accuracy:
        beside_expert = _episodes(players, f"{split}-expert-states")
        yield "Category accuracy", summarise(beside_expert, category_accuracy)
        yield "Pick accuracy", summarise(beside_expert, pick_accuracy)


def _of_rollouts(episodes: Sequence[Episode]) -> Iterator[tuple[str, Interval]]:
    for name, metric in METRICS.items():
        yield name, summarise(episodes, metric)


def _group(episodes: Sequence[Episode], metrics: Iterator[tuple[str, Interval]]) -> dict:
    return {
        "episodes": len(episodes),
        "metrics": {name: interval.rounded() for name, interval in metrics},
    }

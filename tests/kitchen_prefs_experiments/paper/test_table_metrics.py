"""The metrics of a table's groups, from the lines that an evaluation wrote."""

import json
from dataclasses import asdict, replace

from kitchen_prefs.metrics import Episode
from kitchen_prefs_experiments.paper.evaluated_policies import Rule
from kitchen_prefs_experiments.paper.prepared_policies import PreparedPolicy
from kitchen_prefs_experiments.paper.result_files import PolicyDescription
from kitchen_prefs_experiments.paper.table_metrics import measure_groups, pick_accuracy
from kitchen_prefs_experiments.paper.table_types import Table

# The expert picks a cup, places it, picks a glass and drops it in the sink.
EXPERT = ("cup", "in top", "glass", "in sink")


def episode(session, preference, *, placed=4, kinds=EXPERT):
    return Episode(
        split="val",
        session=session,
        salt=0,
        preference=preference,
        count=6 + session % 2,
        decisions=tuple(range(len(kinds))),
        kinds=kinds,
        expert_decisions=tuple(range(len(EXPERT))),
        expert_kinds=EXPERT,
        placed=(placed, placed),
        expert_placed=(4, 4),
        wrong_rack=0,
        sunk=0,
        expert_sunk=0,
        refused=(False,) * len(kinds),
        blocked_places=0,
        longest_loop=0,
        turns=(0, 0),
        closed_early=0,
        closed=True,
        finished=True,
        actions=((0.0,) * 7,) * len(kinds),
    )


def table(*metrics, prompt_use=(), by_count=False):
    rows = {"symbolic": Rule("symbolic")}
    return Table("", "", "", rows, ("val",), metrics, prompt_use=prompt_use, by_count=by_count)


def evaluated(folder, preference=None, **files):
    """A policy whose evaluation wrote val.jsonl, and others with a longer name."""
    one = PreparedPolicy([], folder, PolicyDescription(), preference)
    one.episodes.mkdir(parents=True)
    for kind, episodes in files.items():
        name = "val" if kind == "val" else f"val-{kind.replace('_', '-')}"
        lines = "".join(json.dumps(asdict(line)) + "\n" for line in episodes)
        (one.episodes / f"{name}.jsonl").write_text(lines)
    return one


def mean(groups, metric, group="val"):
    return groups[group].metrics[metric].mean


def test_a_policy_counts_on_the_sessions_of_its_preference_alone(tmp_path):
    episodes = [episode(0, 0), episode(1, 0), episode(2, 1, placed=0), episode(3, 1, placed=0)]
    everyone = measure_groups(table("PE"), [evaluated(tmp_path / "a", val=episodes)])
    of_first = measure_groups(table("PE"), [evaluated(tmp_path / "b", 0, val=episodes)])
    assert (everyone["val"].episodes, mean(everyone, "PE")) == (4, 0.5)
    assert (of_first["val"].episodes, mean(of_first, "PE")) == (2, 1.0)


def test_several_policies_share_a_row_each_with_its_preference(tmp_path):
    good = [episode(i, i // 2) for i in range(4)]
    bad = [replace(one, placed=(0, 0)) for one in good]
    policies = [evaluated(tmp_path / "a", 0, val=good), evaluated(tmp_path / "b", 1, val=bad)]
    groups = measure_groups(table("PE", by_count=True), policies)
    assert (groups["val"].episodes, mean(groups, "PE")) == (4, 0.5)
    assert {name: group.episodes for name, group in groups.items()} == {"6": 2, "7": 2, "val": 4}


def test_the_order_of_the_lines_changes_nothing(tmp_path):
    episodes = [episode(i, i % 2, placed=i % 5) for i in range(8)]
    forth = measure_groups(table("PE"), [evaluated(tmp_path / "a", val=episodes)])
    back = measure_groups(table("PE"), [evaluated(tmp_path / "b", val=episodes[::-1])])
    assert forth == back


def test_another_preferences_prompt_has_a_metric_of_its_own(tmp_path):
    right = [episode(i, 0) for i in range(2)]
    swapped = [episode(i, 0, placed=1) for i in range(2)]
    one = evaluated(tmp_path, val=right, other_prompt=swapped)
    groups = measure_groups(table("PE", prompt_use=("val",)), [one])
    assert mean(groups, "PE, other prompt") == 0.25
    assert mean(groups, "Prompt use") == 0.75


def test_pick_accuracy_leaves_the_places_out(tmp_path):
    beside = [episode(i, 0, kinds=("cup", "in sink", "tray", "in sink")) for i in range(2)]
    one = evaluated(tmp_path, val=beside, expert_states=beside)
    groups = measure_groups(table("Pick accuracy"), [one])
    assert pick_accuracy(beside[0]) == 0.5
    assert mean(groups, "Pick accuracy") == 0.5
    assert mean(groups, "Category accuracy") == 0.5
    assert pick_accuracy(episode(0, 0, kinds=("cup", "in sink", "glass", "in top"))) == 1

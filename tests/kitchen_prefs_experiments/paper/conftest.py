"""Results of a table that was not run."""

import pytest

from kitchen_prefs.metrics import Interval
from kitchen_prefs_experiments.paper.evaluated_policies import FineTuning, Training
from kitchen_prefs_experiments.paper.paper_tables import TABLES
from kitchen_prefs_experiments.paper.result_files import (
    GroupResults,
    PolicyDescription,
    PolicyResults,
    PolicyRow,
)


def training_times(policy):
    """What a row says of its trainings: of a fine-tuning a few seconds for each."""
    match policy:
        case Training():
            return {"seconds": 900}
        case FineTuning():
            seconds = [3 + n for n, _ in enumerate(policy.trainings)]
            return {"policies": [PolicyDescription(seconds=each) for each in seconds]}
    return {}


def made_up(name):
    """The results of a table in which every mean is 0.4, and the symbolic rule's 0.8."""
    table = TABLES[name]
    rows = {}
    for label, policy in table.rows.items():
        mean = 0.8 if label == "symbolic" else 0.4
        interval = Interval(mean, mean - 0.1, mean + 0.1)
        groups = {
            group: GroupResults(
                episodes=70,
                metrics={  # a dictionary of its own, so that a test may change it
                    metric: interval
                    for metric in table.metrics
                    if metric != "Prompt use" or group in table.prompt_use
                },
            )
            for group in table.groups
        }
        rows[label] = PolicyRow(groups=groups, **training_times(policy))
    conditions = {"recipes": table.recipes, "budget": 32_000} if table.trains else {}
    return PolicyResults.of_this_version(name, rows, **conditions)


@pytest.fixture
def made_up_results():
    """Makes results of a table."""
    return made_up

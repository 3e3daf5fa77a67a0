"""The headlines of floor and ceiling on each split, between which a headline is rescaled."""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import numpy as np

REFERENCES = Path(__file__).with_name("reference_scores.json")
PEOPLE_REFERENCES = Path(__file__).with_name("people_reference_scores.json")

References = Mapping[str, Mapping[str, float]]  # of each split, the floor and the ceiling


@cache
def reference_scores() -> References:
    """The Score of the floor and of the ceiling on each test split of the first tier.

    The floor is the rule `promptless`, which acts by the posterior over all 2 x 7! preferences
    without a prompt; the ceiling is `bayes`, which has the prompt as well.
    """
    return json.loads(REFERENCES.read_text())


@cache
def people_reference_scores() -> References:
    """H of the floor and of the ceiling on each split of the second tier but that of training.

    The floor is the most probable user of the grammar without a prompt; the ceiling is the exact
    reader of the grammar, which has the prompts as well. `kitchen-prefs people ladder --record`
    measures both.
    """
    return json.loads(PEOPLE_REFERENCES.read_text())


def rescaled[Value: (float, np.ndarray)](value: Value, of_split: Mapping[str, float]) -> Value:
    """(value - floor) / (ceiling - floor) of a split, clipped at neither end."""
    floor, ceiling = of_split["floor"], of_split["ceiling"]
    return (value - floor) / (ceiling - floor)

"""The metrics: functions of an episode, and their means with intervals.

episode     the facts of one finished episode
scores      the metrics, each a function of an episode
intervals   means over episodes with 95 % intervals
references  the headlines of floor and ceiling, between which a headline is rescaled
people_*    the same for the second tier
"""

from kitchen_prefs.metrics.episode import Episode
from kitchen_prefs.metrics.intervals import (
    Interval,
    mean_of_groups,
    mean_of_splits,
    mean_of_splits_all,
    prompt_use,
    summarise,
    summarise_all,
    wilson,
    wilson_success,
)
from kitchen_prefs.metrics.references import reference_scores
from kitchen_prefs.metrics.scores import (
    ALL_METRICS,
    FURTHER_METRICS,
    METRICS,
    Metric,
    category_accuracy,
    category_edit_similarity,
    category_edit_similarity_without_refused,
    count_failure_modes,
    edit_similarity,
    failure_modes,
    packing_efficiency,
    refused_decisions,
    rescaled_score,
    score,
    success,
    temporal_efficiency,
    turn_accuracy,
)

__all__ = [
    "ALL_METRICS",
    "FURTHER_METRICS",
    "METRICS",
    "Episode",
    "Interval",
    "Metric",
    "category_accuracy",
    "category_edit_similarity",
    "category_edit_similarity_without_refused",
    "count_failure_modes",
    "edit_similarity",
    "failure_modes",
    "mean_of_groups",
    "mean_of_splits",
    "mean_of_splits_all",
    "packing_efficiency",
    "prompt_use",
    "reference_scores",
    "refused_decisions",
    "rescaled_score",
    "score",
    "success",
    "summarise",
    "summarise_all",
    "temporal_efficiency",
    "turn_accuracy",
    "wilson",
    "wilson_success",
]

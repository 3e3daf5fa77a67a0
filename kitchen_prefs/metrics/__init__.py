"""The metrics: functions of an episode, and their means with intervals.

episode    the facts of one finished episode
scores     the metrics, each a function of an episode
intervals  means over episodes with 95 % bootstrap intervals
"""

from kitchen_prefs.metrics.episode import Episode
from kitchen_prefs.metrics.intervals import Interval, mean_of_splits, prompt_use, summarise
from kitchen_prefs.metrics.scores import (
    METRICS,
    Metric,
    category_accuracy,
    category_edit_similarity,
    edit_similarity,
    failure_modes,
    packing_efficiency,
    score,
    success,
    temporal_efficiency,
)

__all__ = [
    "METRICS",
    "Episode",
    "Interval",
    "Metric",
    "category_accuracy",
    "category_edit_similarity",
    "edit_similarity",
    "failure_modes",
    "mean_of_splits",
    "packing_efficiency",
    "prompt_use",
    "score",
    "success",
    "summarise",
    "temporal_efficiency",
]

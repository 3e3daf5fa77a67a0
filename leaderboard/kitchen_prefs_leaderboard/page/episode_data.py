"""What the page shows of an episode, as numbers that are short in JSON."""

from kitchen_prefs.metrics import (
    Episode,
    category_edit_similarity,
    failure_modes,
    packing_efficiency,
    score,
    success,
)

DIGITS = 3  # of an episode's metrics


def episode_data(episode: Episode) -> list:
    """A policy's decisions in an episode, and their result.

    Returns:
        Decisions; the steps at which they were refused; Score, PE and ED_c; whether it is a
        success; one bit for each of `failure_modes`.
    """
    metrics = (score, packing_efficiency, category_edit_similarity)
    modes = failure_modes(episode).values()
    return [
        episode.decisions,
        [step for step, refused in enumerate(episode.refused) if refused],
        [round(metric(episode), DIGITS) for metric in metrics],
        int(success(episode)),
        sum((times > 0) << bit for bit, times in enumerate(modes)),
    ]

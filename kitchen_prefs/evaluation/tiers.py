"""The two tiers of the benchmark: each has its own splits, kitchen, episodes and metrics.

What evaluates, writes or ranks episodes asks the tier of a split for them and knows no tier itself.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from kitchen_prefs import metrics
from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.envs.episode_simulator import EpisodeSimulator
from kitchen_prefs.envs.kitchen_env import KitchenEnv
from kitchen_prefs.envs.people_environment import DishwasherPeople
from kitchen_prefs.envs.people_simulator import PeopleSimulator
from kitchen_prefs.envs.simulator import Simulator
from kitchen_prefs.metrics import Episode, Interval, people_episode, people_intervals
from kitchen_prefs.metrics.people_episode import PeopleEpisode
from kitchen_prefs.metrics.references import (
    References,
    people_reference_scores,
    reference_scores,
)
from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.people.splits import PEOPLE_DATA_VERSION, PEOPLE_SPLITS, PEOPLE_TEST_SPLITS
from kitchen_prefs.simulation.sessions import make_session
from kitchen_prefs.splits import DATA_VERSION, SEEN_USERS, SPLITS, TEST_SPLITS
from kitchen_prefs.utils.suggestions import suggest

AnyEpisode = Episode | PeopleEpisode

# What an environment shows and how it is rolled out, if nothing else is asked for.
USUAL = {
    "track": "standard",
    "prompt_of": "same",
    "prompts": 1,
    "given": None,
    "expert_states": False,
}


@dataclass(frozen=True, eq=False)
class Tier:
    """One tier.

    Attributes:
        name: "preferences" or "people".
        title: The same as a heading.
        data_version: The version of its sessions.
        splits: Its splits, by their names.
        val: The split on which checkpoints are compared.
        test_splits: The splits of the leaderboard.
        make_environment: Its environment, of a split and what `environment` takes.
        make_simulator: A session simulated, of a split, the session's index and, if it is not a
            published one, its session seed (salt).
        varies: Whether anything but `USUAL` can be asked for.
        episode: The facts of its episodes.
        metrics: Its metrics, each a function of an episode.
        success: LeRobot's `is_success`, of an episode.
        failure_modes: How often each failure mode occurred in an episode.
        summarise: The mean and interval of each metric over the episodes of one split.
        mean_of_splits: The same over several splits, each of which counts the same.
        tables: The names of all that is summarised, in tables as wide as a terminal.
        headline: That of `tables` by which checkpoints are compared.
        ranking: That of `tables` by whose mean over the test splits entries are ranked.
        session_headlines: What each session of a split contributes to the mean of `ranking`.
        references: The headline of the floor and of the ceiling on its splits.
        groups: What its episodes can be grouped by.
        training_users: Those of the users of its test splits whom training shows, too.
        floor: The rule that is the floor.
        ceiling: The rule that is the ceiling.
    """

    name: str
    title: str
    data_version: int
    splits: Mapping[str, Any]
    val: str
    test_splits: tuple[str, ...]
    make_environment: Callable[..., KitchenEnv]
    make_simulator: Callable[..., Simulator]
    varies: bool
    episode: type[Episode] | type[PeopleEpisode]
    metrics: Mapping[str, Callable[[Any], float | None]]
    success: Callable[[Any], bool]
    failure_modes: Callable[[Any], dict[str, int]]
    summarise: Callable[[Any], dict[str, Interval]]
    mean_of_splits: Callable[[Any], dict[str, Interval]]
    tables: tuple[tuple[str, ...], ...]
    headline: str
    ranking: str
    session_headlines: Callable[[Any], list[float]]
    references: Callable[[], References]
    groups: tuple[str, ...]
    training_users: tuple[int, ...]
    floor: str
    ceiling: str

    def sessions(self, split: str) -> int:
        """How many sessions a split has."""
        return self.splits[split].sessions

    def prompts(self, split: str, asked: int) -> int:
        """How many demonstrations prompt an episode: as asked, or as the split says."""
        return asked if self.varies else self.splits[split].prompts

    def environment(self, split: str, **asked: Any) -> KitchenEnv:
        """An environment of a split.

        Args:
            split: The split's name.
            asked: What is not as in `USUAL`.

        Raises:
            ValueError: If it does not exist.
        """
        self.check(**asked)
        return self.make_environment(split, **(asked if self.varies else {}))

    def check(self, **asked: Any) -> None:
        """Make sure that the tier can be evaluated as asked for.

        Raises:
            ValueError: If it cannot.
        """
        if not self.varies and any(value != USUAL[name] for name, value in asked.items()):
            raise ValueError(
                f"The tier {self.name!r} has the standard track and its own prompts alone; leave "
                "out --track, --prompts, --prompt, --prompt-use and --category-accuracy."
            )


PREFERENCES = Tier(
    name="preferences",
    title="First tier: preferences",
    data_version=DATA_VERSION,
    splits=SPLITS,
    val="val",
    test_splits=TEST_SPLITS,
    make_environment=DishwasherLoading,
    make_simulator=lambda *session: EpisodeSimulator(make_session(*session)),
    varies=True,
    episode=Episode,
    metrics=metrics.ALL_METRICS,
    success=metrics.success,
    failure_modes=metrics.failure_modes,
    summarise=metrics.summarise_all,
    mean_of_splits=metrics.mean_of_splits_all,
    tables=(tuple(metrics.METRICS), tuple(metrics.FURTHER_METRICS)),
    headline="Score",
    ranking="Score",
    session_headlines=lambda episodes: list(map(metrics.score, episodes)),
    references=reference_scores,
    groups=("preference", "count"),
    training_users=SEEN_USERS,
    floor="promptless",
    ceiling="bayes",
)
PEOPLE = Tier(
    name="people",
    title="Second tier: people",
    data_version=PEOPLE_DATA_VERSION,
    splits=PEOPLE_SPLITS,
    val="people_val",
    test_splits=PEOPLE_TEST_SPLITS,
    make_environment=DishwasherPeople,
    make_simulator=lambda *session: PeopleSimulator(make_people_session(*session)),
    varies=False,
    episode=PeopleEpisode,
    metrics=people_episode.PEOPLE_METRICS,
    success=people_episode.success,
    failure_modes=people_episode.failure_modes,
    summarise=people_intervals.summarise_people,
    mean_of_splits=people_intervals.mean_of_people_splits,
    tables=(
        ("H", "Rescaled", "Care", "Where", "Turn"),
        ("Style", "Refused", "Left open", "TE"),
    ),
    headline="H",
    ranking="Rescaled",
    session_headlines=people_intervals.session_headlines,
    references=people_reference_scores,
    groups=(),
    training_users=(),
    floor="people_promptless",
    ceiling="people_bayes",
)
TIERS = {tier.name: tier for tier in (PREFERENCES, PEOPLE)}


def tier_of(split: str) -> Tier:
    """The tier that has a split.

    Raises:
        ValueError: If none has; the message suggests the nearest.
    """
    for tier in TIERS.values():
        if split in tier.splits:
            return tier
    names = [name for tier in TIERS.values() for name in tier.splits]
    raise ValueError(f"There is no split {split!r}. {suggest(split, names)}")

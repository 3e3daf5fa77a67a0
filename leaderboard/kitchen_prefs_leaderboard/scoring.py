"""Scores submissions: every metric, from replays alone."""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from tqdm import tqdm

from kitchen_prefs.datasets.manifest import published_fingerprint
from kitchen_prefs.evaluation.tiers import Tier, tier_of
from kitchen_prefs.metrics import Interval, count_failure_modes
from kitchen_prefs.utils.visible_text import alike_key
from kitchen_prefs_leaderboard.replay import replay_split
from kitchen_prefs_leaderboard.submission_format import Submission
from kitchen_prefs_leaderboard.submission_reading import SubmissionFiles, read_submission

MEAN = "mean"  # used like a split's name, for the mean in which each split counts the same


@dataclass(frozen=True)
class Entry:
    """A submission on one tier, and the episodes of its actions.

    Attributes:
        submission: The description of the submission.
        digest: A hash of the submission's files of the tier.
        episodes: The episodes of each test split of the tier.
    """

    submission: Submission
    digest: str
    episodes: dict[str, list[Any]]

    @property
    def tier(self) -> Tier:
        """The tier of its splits."""
        return tier_of(next(iter(self.episodes)))

    @cached_property
    def metrics(self) -> dict[str, dict[str, Interval]]:
        """Each metric on each test split, and its mean over them."""
        of_splits = {
            split: self.tier.summarise(episodes) for split, episodes in self.episodes.items()
        }
        return {**of_splits, MEAN: self.tier.mean_of_splits(list(self.episodes.values()))}

    @cached_property
    def failure_modes(self) -> dict[str, dict[str, int]]:
        """For each test split, in how many episodes each failure mode occurred."""
        return {
            split: {
                mode: n
                for mode, (n, _) in count_failure_modes(
                    map(self.tier.failure_modes, episodes)
                ).items()
            }
            for split, episodes in self.episodes.items()
        }

    def grouped(self, by: str) -> dict[str, dict[str, dict[str, Interval]]]:
        """Each metric on each split's groups.

        Args:
            by: "preference" or "count".

        Raises:
            ValueError: If the tier has no such groups.
        """
        if by not in self.tier.groups:
            raise ValueError(
                f"Entries of the tier {self.tier.name!r} have no groups by {by}; leave out --by."
            )
        return {
            split: {
                str(group): self.tier.summarise([e for e in episodes if getattr(e, by) == group])
                for group in sorted({getattr(episode, by) for episode in episodes})
            }
            for split, episodes in self.episodes.items()
        }


def score_submissions(folders: Sequence[Path], jobs: int) -> list[Entry]:
    """Read and replay submissions.

    Args:
        folders: The submissions.
        jobs: How many splits are replayed at once, a process for each.

    Raises:
        ValueError: If one does not follow the format, or does not lead to the states that it names,
            or if two have one name.
        OSError: If a process is killed.
    """
    submissions = [read_known(folder) for folder in folders]
    _check_names(submissions)
    return replay_submissions(submissions, jobs)


def shared_checkpoints(entries: Sequence[Entry]) -> list[str]:
    """A sentence for each two entries of one track and one checkpoint."""
    first: dict[tuple[str, str], str] = {}
    sentences = []
    for entry in entries:
        about = entry.submission
        if about.policy.checkpoint is None:
            continue
        other = first.setdefault((about.track, about.policy.checkpoint), about.name)
        if other != about.name:
            sentences.append(f"{about.name!r} and {other!r} are entries of one checkpoint.")
    return sentences


def _check_names(submissions: Sequence[SubmissionFiles]) -> None:
    folders: dict[str, Path] = {}
    for submission in submissions:
        name = submission.description.name
        other = folders.setdefault(alike_key(name), submission.folder)
        if other is not submission.folder:
            raise ValueError(
                f"{submission.folder} and {other} are both named {name!r}, or nearly; rename or "
                "leave out one."
            )


def replay_submissions(
    submissions: Sequence[SubmissionFiles], jobs: int, tier: Tier | None = None
) -> list[Entry]:
    """Replay submissions that were read, see `score_submissions`.

    Args:
        submissions: The submissions.
        jobs: How many splits are replayed at once.
        tier: The tier that is replayed; None for all.

    Returns:
        An entry for each tier of each submission.
    """
    parts = [
        (i, one)
        for i, submission in enumerate(submissions)
        for one in submission.description.tiers
        if tier in (None, one)
    ]
    work = [(i, split) for i, one in parts for split in one.test_splits]
    for i, split in work:
        submissions[i].lines(split)  # quick, and nothing is replayed if one is malformed
    episodes = _replay(submissions, work, jobs)
    return [
        Entry(
            submissions[i].description,
            submissions[i].digest(one),
            {split: episodes[i, split] for split in one.test_splits},
        )
        for i, one in parts
    ]


def read_known(folder: Path) -> SubmissionFiles:
    """Read a submission on data that this version of the benchmark has.

    Raises:
        ValueError: If it is no submission, or of another version of the data.
    """
    submission = read_submission(folder)
    description = submission.description
    for tier in description.tiers:
        version = description.versions[tier.name]
        if version != tier.data_version:
            raise ValueError(
                f"{folder} is of data version {version}; this version of "
                f"kitchen_prefs replays version {tier.data_version}."
            )
    for name, fingerprint in description.fingerprints.items():
        if published_fingerprint(name) != fingerprint:
            raise ValueError(f"{folder} was made with another data set {name!r}.")
    return submission


def _replay(
    submissions: Sequence[SubmissionFiles], work: Sequence[tuple[int, str]], jobs: int
) -> dict[tuple[int, str], list[Any]]:
    """Replay splits of submissions; the first one that is refused ends the work."""
    try:
        with ProcessPoolExecutor(jobs) as pool:
            read, splits = [submissions[i] for i, _ in work], [split for _, split in work]
            replays = pool.map(replay_split, read, splits)
            bar = tqdm(replays, "Replaying", len(work), unit="split", leave=False, disable=None)
            return dict(zip(work, bar, strict=True))
    except BrokenProcessPool as error:
        raise OSError(
            "A process that replays was killed; give fewer --jobs if memory is short."
        ) from error

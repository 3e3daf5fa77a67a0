"""Scores submissions: every metric, from replays alone."""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from pathlib import Path

from tqdm import tqdm

from kitchen_prefs.datasets.manifest import published_fingerprint
from kitchen_prefs.metrics import (
    Episode,
    Interval,
    count_failure_modes,
    failure_modes,
    mean_of_splits_all,
    summarise_all,
)
from kitchen_prefs.splits import DATA_VERSION, TEST_SPLITS
from kitchen_prefs.utils.visible_text import alike_key
from kitchen_prefs_leaderboard.replay import replay_split
from kitchen_prefs_leaderboard.submission_format import Submission
from kitchen_prefs_leaderboard.submission_reading import SubmissionFiles, read_submission

MEAN = "mean"  # used like a split's name, for the mean in which each split counts the same


@dataclass(frozen=True)
class Entry:
    """A submission and the episodes of its actions.

    Attributes:
        submission: The description of the submission.
        digest: A hash of all of the submission's files.
        episodes: The episodes of each test split.
    """

    submission: Submission
    digest: str
    episodes: dict[str, list[Episode]]

    @cached_property
    def metrics(self) -> dict[str, dict[str, Interval]]:
        """Each metric on each test split, and its mean over them."""
        of_splits = {split: summarise_all(episodes) for split, episodes in self.episodes.items()}
        return {**of_splits, MEAN: mean_of_splits_all(list(self.episodes.values()))}

    @cached_property
    def failure_modes(self) -> dict[str, dict[str, int]]:
        """For each test split, in how many episodes each failure mode occurred."""
        return {
            split: {
                mode: n
                for mode, (n, _) in count_failure_modes(map(failure_modes, episodes)).items()
            }
            for split, episodes in self.episodes.items()
        }

    def grouped(self, by: str) -> dict[str, dict[str, dict[str, Interval]]]:
        """Each metric on each split's groups.

        Args:
            by: "preference" or "count".
        """
        return {
            split: {
                str(group): summarise_all([e for e in episodes if getattr(e, by) == group])
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


def replay_submissions(submissions: Sequence[SubmissionFiles], jobs: int) -> list[Entry]:
    """Replay submissions that were read, see `score_submissions`."""
    work = list(product(range(len(submissions)), TEST_SPLITS))
    for i, split in work:
        submissions[i].lines(split)  # quick, and nothing is replayed if one is malformed
    episodes = _replay(submissions, work, jobs)
    return [
        Entry(submission.description, submission.digest, {s: episodes[i, s] for s in TEST_SPLITS})
        for i, submission in enumerate(submissions)
    ]


def read_known(folder: Path) -> SubmissionFiles:
    """Read a submission on data that this version of the benchmark has.

    Raises:
        ValueError: If it is no submission, or of another version of the data.
    """
    submission = read_submission(folder)
    description = submission.description
    if description.data_version != DATA_VERSION:
        raise ValueError(
            f"{folder} is of data version {description.data_version}; this version of "
            f"kitchen_prefs replays version {DATA_VERSION}."
        )
    for name, fingerprint in description.fingerprints.items():
        if published_fingerprint(name) != fingerprint:
            raise ValueError(f"{folder} was made with another data set {name!r}.")
    return submission


def _replay(
    submissions: Sequence[SubmissionFiles], work: Sequence[tuple[int, str]], jobs: int
) -> dict[tuple[int, str], list[Episode]]:
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

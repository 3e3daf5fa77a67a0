"""Re-runs: the one thing that a replay cannot prove is who chose the actions.

A checkpoint that is submitted is loaded and plays again, on the test splits and on fresh sessions
that nobody knew when the submission was made. What came of it is kept by whoever runs the
leaderboard, never in a submission: VERIFICATIONS/<digest of the submission>.json.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, ValidationError

from kitchen_prefs import metrics
from kitchen_prefs.files import write_json
from kitchen_prefs.metrics import Episode, Interval, mean_of_splits
from kitchen_prefs_leaderboard.scoring import MEAN, Entry, difference
from kitchen_prefs_leaderboard.submission import (
    Hash,
    Name,
    Strict,
    Submission,
    installed_packages,
)

if TYPE_CHECKING:
    from kitchen_prefs_leaderboard.playing import Player  # brings torch


class Means(Strict):
    """A mean and its 95 % interval."""

    mean: float
    low: float
    high: float


class Verification(Strict):
    """What a re-run of a submission came to.

    Attributes:
        digest: The hash of the submission's files.
        packages: The versions of the programs that ran it.
        salt: Which drawing of fresh sessions it played, too.
        same: The share of the submission's episodes in which it decided the same.
        replayed: Score of the submission's actions.
        rerun: Score of the policy on the same sessions.
        fresh: Score of the policy on the fresh sessions.
        confirmed: Whether the re-run confirms the submission.
    """

    digest: Hash
    packages: Annotated[dict[Name, Name], Field(max_length=50)]
    salt: Annotated[int, Field(ge=1)]
    same: Annotated[float, Field(ge=0, le=1)]
    replayed: Means
    rerun: Means
    fresh: Means
    confirmed: bool


def read_verifications(folder: Path) -> dict[str, Verification]:
    """The re-runs that confirm a submission, by the submission's digest.

    Raises:
        ValueError: If a file is no `Verification`.
    """
    found = {}
    for file in sorted(folder.glob("*.json")):
        try:
            verification = Verification.model_validate_json(file.read_bytes())
        except ValidationError as error:
            raise ValueError(
                f"{file} is no record of a re-run; delete it and verify anew."
            ) from error
        if verification.confirmed:
            found[verification.digest] = verification
    return found


def write_verification(verification: Verification, folder: Path) -> Path:
    """Keep what a re-run came to."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{verification.digest}.json"
    write_json(file, verification.model_dump())
    return file


def check_policy(submission: Submission, checkpoint: str) -> None:
    """Make sure that a policy is the one that a submission names.

    Args:
        submission: Who is said to have acted.
        checkpoint: The fingerprint of the policy that is to run again.

    Raises:
        ValueError: If it is another one, or if the submission names none.
    """
    named = submission.policy.checkpoint
    if named is None:
        raise ValueError("The submission names no checkpoint, so nothing can be run again.")
    if named != checkpoint:
        raise ValueError(
            f"The submission is of a policy with the fingerprint {named[:12]}, and this one has "
            f"{checkpoint[:12]}; give the submission's --policy.path or --policy.type."
        )


def run_again(entry: Entry, player: "Player", salt: int, folder: Path, jobs: int) -> Verification:
    """Let a policy play the published and fresh sessions, and hold both against a submission.

    Args:
        entry: The submission, replayed.
        player: The policy that is said to have chosen its actions.
        salt: Draws the fresh sessions.
        folder: Keeps the episodes; what is played already is not played again.
        jobs: How many processes share the splits.

    Raises:
        ValueError: If it is another policy.
        OSError: If an evaluation fails; the message names its log.
    """
    check_policy(entry.submission, player.actor.fingerprint)
    rerun, fresh = (player.play(folder / f"salt-{drawing}", drawing, jobs) for drawing in (0, salt))
    return judge(entry, rerun, fresh, salt)


def judge(
    entry: Entry,
    rerun: Mapping[str, Sequence[Episode]],
    fresh: Mapping[str, Sequence[Episode]],
    salt: int,
) -> Verification:
    """Hold a re-run against a submission.

    It confirms the submission if on the same sessions the paired interval of the difference in
    Score holds zero, and if the policy is not worse on fresh sessions: then it has not merely
    learned the published ones.

    Args:
        entry: The submission, replayed.
        rerun: Its policy's episodes on the same sessions, by split.
        fresh: Its policy's episodes on fresh sessions, by split.
        salt: Draws the fresh sessions.
    """
    mine = {(e.split, e.session): e for episodes in entry.episodes.values() for e in episodes}
    pairs = [(mine[e.split, e.session], e) for episodes in rerun.values() for e in episodes]
    gain = difference(rerun, entry.episodes)
    replayed = entry.metrics[MEAN]["Score"]
    anew = mean_of_splits(list(fresh.values()), metrics.score)
    return Verification(
        digest=entry.digest,
        packages=installed_packages(),
        salt=salt,
        same=sum(one.decisions == other.decisions for one, other in pairs) / len(pairs),
        replayed=_means(replayed),
        rerun=_means(mean_of_splits(list(rerun.values()), metrics.score)),
        fresh=_means(anew),
        confirmed=gain.low <= 0 <= gain.high and anew.high >= replayed.low,
    )


def _means(interval: Interval) -> Means:
    return Means(**{name: round(value, 4) for name, value in asdict(interval).items()})

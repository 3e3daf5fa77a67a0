"""Re-runs: they prove what a replay cannot, that the policy chose the actions.

The submitted checkpoint is rolled out again, on the test splits and on fresh sessions, which were
not known when the submission was made. The record is kept by the maintainers of the leaderboard,
never in a submission: VERIFICATIONS/<digest of the submission>.json.
"""

import secrets
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from math import hypot
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from pydantic import Field, ValidationError

from kitchen_prefs.envs.session_choice import FRESH_SALTS
from kitchen_prefs.metrics import Episode, Interval, mean_of_splits, score
from kitchen_prefs.utils.files import write_json
from kitchen_prefs_leaderboard.scoring import MEAN, Entry, difference
from kitchen_prefs_leaderboard.submission_format import (
    Hash,
    Name,
    Policy,
    Strict,
    Submission,
    installed_packages,
)

if TYPE_CHECKING:
    from kitchen_prefs_leaderboard.policy_runs import PolicyRun  # imports torch


class ScoreInterval(Strict):
    """The mean Score over the test splits and its 95 % interval."""

    mean: float
    low: float
    high: float


class Verification(Strict):
    """The result of a re-run.

    Attributes:
        digest: The hash of the submission's files.
        packages: The versions of the packages that ran it.
        salt: The session seed of the fresh sessions.
        same: The share of episodes with the same decisions as in the submission.
        replayed: Score of the submission's actions.
        rerun: Score of the policy on the same sessions.
        fresh: Score of the policy on the fresh sessions.
        repeats: Whether its Score on the same sessions agrees with the submission's.
        generalises: Whether its Score on the fresh sessions is not significantly lower.
    """

    digest: Hash
    packages: Annotated[dict[Name, Name], Field(max_length=50)]
    salt: Annotated[int, Field(ge=1)]
    same: Annotated[float, Field(ge=0, le=1)]
    replayed: ScoreInterval
    rerun: ScoreInterval
    fresh: ScoreInterval
    repeats: bool
    generalises: bool

    @property
    def confirmed(self) -> bool:
        """Whether the re-run confirms the submission."""
        return self.repeats and self.generalises


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
                f"{file} is no record of a re-run; delete it and verify again."
            ) from error
        if verification.confirmed:
            found[verification.digest] = verification
    return found


def write_verification(verification: Verification, folder: Path) -> Path:
    """Write the record of a re-run."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{verification.digest}.json"
    write_json(file, verification.model_dump())
    return file


def check_policy(submission: Submission, policy: Policy) -> None:
    """Check that a policy is the one that a submission names.

    Args:
        submission: The description of the submission.
        policy: The policy that is to be rolled out.

    Raises:
        ValueError: If it is another one, or if the submission names none.
    """
    if submission.policy.checkpoint is None:
        raise ValueError("The submission names no checkpoint, so it cannot be re-run.")
    if submission.policy != policy:
        raise ValueError(
            f"The submission is of another policy ({_named(submission.policy)}) than this one "
            f"({_named(policy)}); give the submission's --policy.path or --policy.type."
        )


def session_seed(folder: Path) -> int:
    """The session seed (salt) of a re-run that was started in a folder, or else a new one."""
    begun = sorted(folder.glob("salt-[1-9]*"))
    if begun:
        return int(begun[0].name.removeprefix("salt-"))
    return secrets.randbelow(FRESH_SALTS - 1) + 1


def rerun_policy(
    entry: Entry, policy: "PolicyRun", salt: int, folder: Path, jobs: int
) -> Verification:
    """Roll a policy out on the published and on fresh sessions, and compare with a submission.

    Args:
        entry: The submission, replayed.
        policy: The policy that the submission names.
        salt: The session seed of the fresh sessions.
        folder: The folder of the episodes; those that it holds are reused.
        jobs: How many processes share the splits.

    Raises:
        OSError: If an evaluation fails; the message names its log.
    """
    rerun, fresh = (policy.roll_out(folder / f"salt-{seed}", seed, jobs) for seed in (0, salt))
    return compare(entry, rerun, fresh, salt)


def compare(
    entry: Entry,
    rerun: Mapping[str, Sequence[Episode]],
    fresh: Mapping[str, Sequence[Episode]],
    salt: int,
) -> Verification:
    """Compare a re-run with a submission.

    It confirms the submission if on the same sessions the paired interval of the difference in
    Score holds zero, and if on fresh sessions the policy is not worse by more than both intervals
    allow, their half-widths combined as for independent means: it is not fitted to the published
    sessions.

    Args:
        entry: The submission, replayed.
        rerun: Its policy's episodes on the same sessions, by split.
        fresh: Its policy's episodes on fresh sessions, by split.
        salt: The session seed of the fresh sessions.
    """
    mine = {(e.split, e.session): e for episodes in entry.episodes.values() for e in episodes}
    pairs = [(mine[e.split, e.session], e) for episodes in rerun.values() for e in episodes]
    gain = difference(rerun, entry.episodes)
    replayed = entry.metrics[MEAN]["Score"]
    on_fresh = mean_of_splits(list(fresh.values()), score)
    return Verification(
        digest=entry.digest,
        packages=installed_packages(),
        salt=salt,
        same=sum(one.decisions == other.decisions for one, other in pairs) / len(pairs),
        replayed=_score_interval(replayed),
        rerun=_score_interval(mean_of_splits(list(rerun.values()), score)),
        fresh=_score_interval(on_fresh),
        repeats=gain.low <= 0 <= gain.high,
        generalises=replayed.mean - on_fresh.mean
        <= hypot(replayed.mean - replayed.low, on_fresh.high - on_fresh.mean),
    )


def _named(policy: Policy) -> str:
    checkpoint = (policy.checkpoint or "no checkpoint")[:12]
    return f"{policy.type}, {policy.parameters} parameters, {checkpoint}"


def _score_interval(interval: Interval) -> ScoreInterval:
    return ScoreInterval(**asdict(interval.rounded()))

"""The records of re-runs, which prove what a replay cannot, that the policy chose the actions.

The submitted policy is rolled out again in a process of its own (`reruns`) and judged
(`judgement`). The maintainers of the leaderboard keep the record, never a submission:
VERIFICATIONS/<digest of the submission>.json.
What a re-run cannot prove stands in leaderboard/README.md.
"""

from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, ValidationError

from kitchen_prefs.utils.files import write_json
from kitchen_prefs.utils.untrusted_files import Strict
from kitchen_prefs_leaderboard.submission_format import (
    Hash,
    Name,
    Plugin,
    Policy,
    Submission,
)

# 1: in the scorer's own process, judged by the submission's own interval; 2: as `reruns` says.
PROCEDURE: Literal[2] = 2


class ScoreInterval(Strict):
    """The mean headline over the test splits of a tier and its 95 % interval.

    The headline is Score, and rescaled H in the second tier.
    """

    mean: float
    low: float
    high: float


class Verification(Strict):
    """The result of a re-run.

    Attributes:
        procedure: Which procedure it followed, see `PROCEDURE`.
        digest: The hash of the submission's files of one tier.
        by: Who re-ran it.
        sandbox: Whether the policy's process was confined.
        packages: The versions of the packages that ran it.
        salt: The session seed of the fresh sessions.
        runs: How often the policy was rolled out on the published sessions.
        same: The share of episodes with the same decisions as in the submission.
        itself: The share of episodes with the same decisions in two runs in batches; None for one.
        alone: The share of the episodes that were rolled out in a batch of their own and went as
            in a batch with others.
        replayed: The headline of the submission's actions.
        rerun: That of the policy on the same sessions.
        fresh: That of the policy on the fresh sessions.
        scores: What each session of each test split contributes to the policy's headline; of a
            policy that does not repeat itself, in the run with each session in a batch of its own.
        repeats: Whether the policy does what the submission says.
        independent: Whether an episode does not depend on others.
        generalises: Whether its headline on the fresh sessions is not significantly lower.
    """

    procedure: Literal[1, 2] = 1
    digest: Hash
    by: Name = "unknown"
    sandbox: bool = False
    packages: Annotated[dict[Name, Name], Field(max_length=50)]
    salt: Annotated[int, Field(ge=1)]
    runs: Annotated[int, Field(ge=1)] = 1
    same: Annotated[float, Field(ge=0, le=1)]
    itself: Annotated[float, Field(ge=0, le=1)] | None = None
    alone: Annotated[float, Field(ge=0, le=1)] | None = None
    replayed: ScoreInterval
    rerun: ScoreInterval
    fresh: ScoreInterval
    scores: dict[Name, list[float]] | None = None
    repeats: bool
    independent: bool = True
    generalises: bool

    @property
    def confirmed(self) -> bool:
        """Whether the re-run confirms the submission."""
        return self.repeats and self.independent and self.generalises


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
    if submission.policy.plugin != policy.plugin:
        raise ValueError(
            f"The submission's policy comes from {_plugin_named(submission.policy.plugin)}, and "
            f"this one from {_plugin_named(policy.plugin)}; install the submission's."
        )
    if submission.policy != policy:
        raise ValueError(
            f"The submission is of another policy ({_named(submission.policy)}) than this one "
            f"({_named(policy)}); give the submission's --policy.path or --policy.type."
        )


def _named(policy: Policy) -> str:
    checkpoint = (policy.checkpoint or "no checkpoint")[:12]
    return f"{policy.type}, {policy.parameters} parameters, {checkpoint}"


def _plugin_named(plugin: Plugin | None) -> str:
    if plugin is None:
        return "LeRobot or this benchmark"
    return f"{plugin.distribution} {plugin.version} (code {plugin.code[:12]})"

"""A submission: its description and every action. It holds no score.

FOLDER/
    submission.json            authors, policy, versions: a `Submission`
    seen.jsonl.bz2             one `Line` per episode, in the order of the sessions
    unseen_preferences.jsonl.bz2
    ...                        one such file for each test split of the tiers that it covers
"""

from importlib.metadata import version
from typing import Annotated, Literal, Self, get_args

from pydantic import AfterValidator, Field, StringConstraints, model_validator

from kitchen_prefs.envs.kitchen_env import MAX_EPISODE_STEPS
from kitchen_prefs.evaluation.tiers import PREFERENCES, TIERS, Tier
from kitchen_prefs.utils.untrusted_files import Strict
from kitchen_prefs.utils.visible_text import check_public_link, check_visible

# The version of this format. 1: the test splits of the first tier; 2: those of the tiers that it
# names. Who submits on the first tier alone still writes 1.
Format = Literal[1, 2]
DESCRIPTION = "submission.json"
ACTIONS = {split: f"{split}.jsonl.bz2" for tier in TIERS.values() for split in tier.test_splits}
# The packages that an episode depends on, by their well-known names.
PACKAGES = {
    "kitchen_prefs": "lerobot_policy_kitchen_prefs",
    **{name: name for name in ("lerobot", "torch", "mujoco", "numpy", "gymnasium")},
}
UNSPECIFIED = "not specified"
TierName = Literal["preferences", "people"]
Track = Literal["standard", "privileged", "language", "open"]
TRACKS: tuple[str, ...] = get_args(Track)

# Words separated by single spaces, without control characters and line breaks, because a terminal
# shows names; they begin with a letter or digit, because a spreadsheet would evaluate "=".
WORDS = r"^[\p{L}\p{N}][^\p{C}\p{Z}]*( [^\p{C}\p{Z}]+)*$"
VISIBLE = AfterValidator(check_visible)
Text = Annotated[str, StringConstraints(max_length=200, pattern=WORDS), VISIBLE]
Name = Annotated[str, StringConstraints(max_length=60, pattern=WORDS), VISIBLE]
Link = Annotated[
    str,
    StringConstraints(max_length=300, pattern=r"^https?://[^\s\p{C}\"'<>]+$"),
    AfterValidator(check_public_link),
]
Version = Annotated[int, Field(ge=1, le=1000)]
Hash = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]  # SHA-256, hexadecimal
# A pose in the kitchen, which is some metres wide: position (m) and quaternion (wxyz).
FARTHEST = 1000
Number = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]
Pose = tuple[Number, Number, Number, Number, Number, Number, Number]


class Plugin(Strict):
    """The package of a policy from elsewhere, see `plugin_identity`.

    Attributes:
        distribution: The name under which it is installed.
        version: Its version.
        code: The hash of its files.
    """

    distribution: Name
    version: Name
    code: Hash


class Policy(Strict):
    """The policy that chose the actions.

    Attributes:
        type: The policy's type, such as "ttp"; any name for another program.
        parameters: The number of learned parameters; None where that does not apply.
        checkpoint: The fingerprint of a LeRobot checkpoint; None for another program, whose
            actions can be replayed but not re-run.
        plugin: Where its code comes from; None for LeRobot's policies and this repository's.
    """

    type: Name
    parameters: Annotated[int, Field(ge=0, le=10**13)] | None = None
    checkpoint: Hash | None = None
    plugin: Plugin | None = None


class Submission(Strict):
    """The description of a submission.

    Attributes:
        format: The version of this format.
        name: The name of the entry.
        authors: Who submits it.
        link: Where to read more.
        track: What the policy may use.
        policy: The policy that chose the actions.
        data_version: The version of the sessions, in format 1.
        data_versions: That of each tier that is covered, in format 2.
        fingerprints: The fingerprints of the test splits' data sets.
        packages: The versions of the packages.
        hardware: The hardware of the training.
        training: The data and the number of steps of the training.
    """

    format: Format
    name: Name
    authors: Annotated[list[Name], Field(min_length=1, max_length=50)]
    link: Link | None = None
    track: Track
    policy: Policy
    data_version: Version | None = None
    data_versions: Annotated[dict[TierName, Version], Field(min_length=1)] | None = None
    fingerprints: Annotated[dict[Name, Hash], Field(max_length=20)]
    packages: Annotated[dict[Name, Name], Field(max_length=50)]
    hardware: Text
    training: Text

    @model_validator(mode="after")
    def _check_versions(self) -> Self:
        named = (self.data_version is not None, self.data_versions is not None)
        if named != (self.format == 1, self.format == 2):
            raise ValueError("Format 1 has a data_version, format 2 has data_versions.")
        return self

    @property
    def versions(self) -> dict[str, int]:
        """The version of the sessions of each tier that is covered."""
        if self.data_versions is None:
            return {PREFERENCES.name: self.data_version or 0}
        return dict(self.data_versions.items())

    @property
    def tiers(self) -> list[Tier]:
        """The tiers that are covered."""
        return [tier for name, tier in TIERS.items() if name in self.versions]


class Line(Strict):
    """One episode.

    Attributes:
        session: The session's index.
        first: The hash of its first state.
        actions: The actions, (T, 7).
        last: The hash of its last state and of all decisions that led there.
    """

    session: Annotated[int, Field(ge=0, le=10_000)]
    first: Hash
    actions: Annotated[list[Pose], Field(min_length=1, max_length=MAX_EPISODE_STEPS)]
    last: Hash


def installed_packages() -> dict[str, str]:
    """The versions that are installed here."""
    return {short: version(package) for short, package in PACKAGES.items()}

"""A submission: its description and every action. It holds no score.

FOLDER/
    submission.json            authors, policy, versions: a `Submission`
    seen.jsonl.bz2             one `Line` per episode, in the order of the sessions
    unseen_preferences.jsonl.bz2
    ...                        one such file for each test split
"""

from importlib.metadata import version
from typing import Annotated, Literal, get_args

from pydantic import AfterValidator, Field, StringConstraints

from kitchen_prefs.envs.kitchen_env import MAX_EPISODE_STEPS
from kitchen_prefs.splits import TEST_SPLITS
from kitchen_prefs.utils.untrusted_files import Strict
from kitchen_prefs.utils.visible_text import check_public_link, check_visible

FORMAT = 1  # the version of this format
DESCRIPTION = "submission.json"
ACTIONS = {split: f"{split}.jsonl.bz2" for split in TEST_SPLITS}
# The packages that an episode depends on, by their well-known names.
PACKAGES = {
    "kitchen_prefs": "lerobot_policy_kitchen_prefs",
    **{name: name for name in ("lerobot", "torch", "mujoco", "numpy", "gymnasium")},
}
UNSPECIFIED = "not specified"
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
        data_version: The version of the sessions.
        fingerprints: The fingerprints of the test splits' data sets.
        packages: The versions of the packages.
        hardware: The hardware of the training.
        training: The data and the number of steps of the training.
    """

    format: Literal[1]
    name: Name
    authors: Annotated[list[Name], Field(min_length=1, max_length=50)]
    link: Link | None = None
    track: Track
    policy: Policy
    data_version: Annotated[int, Field(ge=1, le=1000)]
    fingerprints: Annotated[dict[Name, Hash], Field(max_length=20)]
    packages: Annotated[dict[Name, Name], Field(max_length=50)]
    hardware: Text
    training: Text


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

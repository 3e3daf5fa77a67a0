"""A submission: who acted, and every action. It holds no score.

FOLDER/
    submission.json            who, what, with which versions: a `Submission`
    seen.jsonl.bz2             one `Line` an episode, in the order of the sessions
    unseen_preferences.jsonl.bz2
    ...                        one such file for each test split
"""

from importlib.metadata import version
from typing import Annotated, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, StringConstraints, ValidationError

from kitchen_prefs.envs.environment import MAX_EPISODE_STEPS
from kitchen_prefs.splits import TEST_SPLITS

FORMAT = 1  # the version of what is described here
DESCRIPTION = "submission.json"
ACTIONS = {split: f"{split}.jsonl.bz2" for split in TEST_SPLITS}
# What decides how an episode goes, by the names that a reader knows.
PACKAGES = {
    "kitchen_prefs": "lerobot_policy_kitchen_prefs",
    **{name: name for name in ("lerobot", "torch", "mujoco", "numpy", "gymnasium")},
}
NOT_SAID = "not said"
Track = Literal["standard", "privileged", "language", "open"]
TRACKS: tuple[str, ...] = get_args(Track)

# Words with a space between, without control characters and line breaks of any kind, as a name
# stands in terminals, too; a letter or a digit comes first, as "=" would compute in a spreadsheet.
WORDS = r"^[\p{L}\p{N}][^\p{C}\p{Z}]*( [^\p{C}\p{Z}]+)*$"
Text = Annotated[str, StringConstraints(max_length=200, pattern=WORDS)]
Name = Annotated[str, StringConstraints(max_length=60, pattern=WORDS)]
Link = Annotated[str, StringConstraints(max_length=300, pattern=r"^https?://[^\s\p{C}\"'<>]+$")]
Hash = Annotated[str, StringConstraints(pattern=r"^[0-9a-f]{64}$")]  # SHA-256, hexadecimal
# A pose in the kitchen, which is some metres wide: position (m) and quaternion (wxyz).
FARTHEST = 1000
Number = Annotated[float, Field(ge=-FARTHEST, le=FARTHEST)]
Pose = tuple[Number, Number, Number, Number, Number, Number, Number]


class Strict(BaseModel):
    """Nothing that is not described, nothing that is converted, nothing infinite."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


class Policy(Strict):
    """What chose the actions.

    Attributes:
        type: The policy's type, such as "ttp"; of another program any word.
        parameters: How many numbers it has learned; None if that is no sensible question.
        checkpoint: The fingerprint of a LeRobot checkpoint; None for another program, which can be
            replayed and not run again.
    """

    type: Name
    parameters: Annotated[int, Field(ge=0, le=10**13)] | None = None
    checkpoint: Hash | None = None


class Submission(Strict):
    """Who acted, on which data and with which programs.

    Attributes:
        format: The version of this format.
        name: What the row is called.
        authors: Who submits it.
        link: Where to read more.
        track: What the policy was allowed to use.
        policy: What chose the actions.
        data_version: The version of the sessions.
        fingerprints: Those of the test splits' data sets.
        packages: The versions of the programs.
        hardware: What it was trained on.
        training: On what, how long.
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
        actions: The actions, (T, 7); on a wire tuples are lists.
        last: The hash of its last state and of all decisions that led there.
    """

    session: Annotated[int, Field(ge=0, le=10_000)]
    first: Hash
    actions: Annotated[list[Pose], Field(min_length=1, max_length=MAX_EPISODE_STEPS)]
    last: Hash


def complaint(error: ValidationError) -> str:
    """The first thing that is wrong, in a few words that a terminal can show."""
    first = error.errors(include_url=False, include_input=False)[0]
    at = ".".join(str(step)[:40] for step in first["loc"][:6])
    words = f"{f'{at}: ' if at else ''}{first['msg'][:200]}."
    # A field that is too many has whatever name a stranger gave it.
    return "".join(character if character.isprintable() else "?" for character in words)


def installed_packages() -> dict[str, str]:
    """The versions that are installed here."""
    return {short: version(package) for short, package in PACKAGES.items()}

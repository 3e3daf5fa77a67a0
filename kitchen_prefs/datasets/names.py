"""The names of the data sets, what each holds and where it lies."""

import os
import re
from dataclasses import dataclass
from pathlib import Path

from huggingface_hub.constants import HF_HOME

from kitchen_prefs.people.splits import PEOPLE_DATA_VERSION, PEOPLE_SPLITS
from kitchen_prefs.splits import DATA_VERSION, HELD_OUT_USERS, SEEN_USERS, SPLITS
from kitchen_prefs.utils.suggestions import suggest

NAMESPACE = "kitchen_prefs"

# dishwasher-<split>-v1, dishwasher-train-all-v1, dishwasher-train-p<1..7>-d<1..80>-v1: the first p
# preferences of train with d demonstrations each, or dishwasher-prompts-of<8..12>-d<1..80>-v1: the
# first d demonstrations of one held-out preference in prompts.
GRAMMAR = re.compile(
    rf"dishwasher-(?:(?P<split>{'|'.join(SPLITS)})|(?P<all>train-all)"
    r"|(?:train-p(?P<preferences>[1-7])|prompts-of(?P<held_out>[89]|1[0-2]))"
    r"-d(?P<demonstrations>[1-9]|[1-7][0-9]|80))-v(?P<version>[0-9]+)"
)
# dishwasher-<people split>-v2, or dishwasher-people_train-u<1..2000>-v2: the first so many users of
# people_train, both sessions of each.
PEOPLE_GRAMMAR = re.compile(
    rf"dishwasher-(?:(?P<split>{'|'.join(PEOPLE_SPLITS)})"
    r"|people_train-u(?P<users>[1-9][0-9]{0,2}|1[0-9]{3}|2000))-v(?P<version>[0-9]+)"
)


@dataclass(frozen=True)
class Content:
    """What a data set holds.

    Attributes:
        name: The data set's name, such as `dishwasher-train-v1`.
        sessions: The split and the index of each episode's session.
        purpose: What it is for, in a few words.
    """

    name: str
    sessions: tuple[tuple[str, int], ...]
    purpose: str

    @property
    def repo_id(self) -> str:
        """The name that LeRobot's commands take."""
        return f"{NAMESPACE}/{self.name}"

    @property
    def is_of_people(self) -> bool:
        """Whether it is of the second tier."""
        return is_of_people(self.name)


def dataset_names() -> tuple[str, ...]:
    """The published data sets: one a split of both tiers, and `dishwasher-train-all-v1`."""
    first = (f"dishwasher-{part}-v{DATA_VERSION}" for part in (*SPLITS, "train-all"))
    of_people = (f"dishwasher-{split}-v{PEOPLE_DATA_VERSION}" for split in PEOPLE_SPLITS)
    return (*first, *of_people)


def is_in_grammar(name: str) -> bool:
    """Whether a name has the form of a data set's of the benchmark."""
    return bool(GRAMMAR.fullmatch(name)) or is_of_people(name)


def is_of_people(name: str) -> bool:
    """Whether a name has the form of a data set's of the second tier."""
    return bool(PEOPLE_GRAMMAR.fullmatch(name))


def data_version_of(name: str) -> int:
    """The data version of a data set; of one that the benchmark does not make, the first tier's."""
    return PEOPLE_DATA_VERSION if is_of_people(name) else DATA_VERSION


def content_of(name: str) -> Content:
    """What a data set holds.

    Args:
        name: The data set's name, with or without `kitchen_prefs/` before it.

    Raises:
        ValueError: If no data set has this name, or only one of another version.
    """
    name = name.removeprefix(f"{NAMESPACE}/")
    found = PEOPLE_GRAMMAR.fullmatch(name) or GRAMMAR.fullmatch(name)
    if found is None:
        raise ValueError(
            f"There is no data set {name!r}. {suggest(name, dataset_names())} Subsets of train are "
            f"named like dishwasher-train-p4-d40-v{DATA_VERSION}: 1 to 7 preferences, 1 to 80 "
            "demonstrations of each; those of prompts like "
            f"dishwasher-prompts-of8-d1-v{DATA_VERSION}: one of the preferences 8 to 12, 1 to 80 "
            "demonstrations; those of people_train like "
            f"dishwasher-people_train-u50-v{PEOPLE_DATA_VERSION}: 1 to 2000 users."
        )
    version = data_version_of(name)
    if found["version"] != str(version):
        right = name.removesuffix(found["version"]) + str(version)
        raise ValueError(
            f"This version of kitchen_prefs makes this data of version {version}, so not {name!r}; "
            f"ask for {right!r}, or install the version that made the other."
        )
    return _content_of_people(name, found) if is_of_people(name) else _content(name, found)


def dataset_root(name: str) -> Path:
    """The folder of a data set, in `$HF_LEROBOT_HOME` as LeRobot itself finds it."""
    # LeRobot's own rule (lerobot.utils.constants), repeated because importing it takes seconds.
    home = Path(os.environ.get("HF_LEROBOT_HOME", Path(HF_HOME) / "lerobot")).expanduser()
    return home / NAMESPACE / name


def _content(name: str, found: re.Match) -> Content:
    """What a data set of the first tier holds."""
    if found["all"]:
        held_out = _sessions("prompts", HELD_OUT_USERS, 80)
        purpose = "training of privileged baselines on all twelve preferences"
        return Content(name, _sessions("train", SEEN_USERS, 80) + held_out, purpose)
    if found["split"]:
        split = SPLITS[found["split"]]
        return Content(name, tuple((split.name, i) for i in range(split.sessions)), split.purpose)
    demonstrations = int(found["demonstrations"])
    if found["held_out"]:
        number = int(found["held_out"])
        purpose = f"fine-tuning on preference {number}, number of demonstrations: {demonstrations}"
        return Content(name, _sessions("prompts", (number - 1,), demonstrations), purpose)
    preferences = int(found["preferences"])
    purpose = f"training on {preferences} preferences, {demonstrations} demonstrations each"
    sessions = _sessions("train", SEEN_USERS[:preferences], demonstrations)
    return Content(name, sessions, purpose)


def _content_of_people(name: str, found: re.Match) -> Content:
    """What a data set of the second tier holds."""
    split = PEOPLE_SPLITS[found["split"] or "people_train"]
    sessions, purpose = split.sessions, split.purpose
    if found["users"]:
        sessions = int(found["users"]) * split.sessions_each
        purpose = f"training on {found['users']} users"
    return Content(name, tuple((split.name, i) for i in range(sessions)), purpose)


def _sessions(split: str, users: tuple[int, ...], most: int) -> tuple[tuple[str, int], ...]:
    """The first sessions of some users, user by user."""
    chosen = []
    for user in users:
        sessions = [i for i, other in enumerate(SPLITS[split].users) if other == user]
        chosen += [(split, i) for i in sessions[:most]]
    return tuple(chosen)

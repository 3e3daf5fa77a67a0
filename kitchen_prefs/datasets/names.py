"""The names of the data sets, what each holds and where it lies."""

import os
import re
from dataclasses import dataclass
from pathlib import Path

from huggingface_hub.constants import HF_HOME

from kitchen_prefs.splits import DATA_VERSION, HELD_OUT_USERS, SEEN_USERS, SPLITS
from kitchen_prefs.utils.suggestions import suggest

NAMESPACE = "kitchen_prefs"

# dishwasher-<split>-v1, dishwasher-train-all-v1, dishwasher-train-p<1..7>-d<1..80>-v1: the first p
# preferences of train with d demonstrations each, or dishwasher-prompts-of<8..12>-d<1..80>-v1: the
# first d demonstrations of one held-out preference in prompts.
GRAMMAR = re.compile(
    rf"(?:{NAMESPACE}/)?dishwasher-(?:(?P<split>{'|'.join(SPLITS)})|(?P<all>train-all)"
    r"|(?:train-p(?P<preferences>[1-7])|prompts-of(?P<held_out>[89]|1[0-2]))"
    r"-d(?P<demonstrations>[1-9]|[1-7][0-9]|80))-v(?P<version>[0-9]+)"
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


def dataset_names() -> tuple[str, ...]:
    """The published data sets: one a split, and `dishwasher-train-all-v1`."""
    return tuple(f"dishwasher-{part}-v{DATA_VERSION}" for part in (*SPLITS, "train-all"))


def content_of(name: str) -> Content:
    """What a data set holds.

    Args:
        name: The data set's name, with or without `kitchen_prefs/` before it.

    Raises:
        ValueError: If no data set has this name, or only one of another version.
    """
    found = GRAMMAR.fullmatch(name)
    if found is None:
        raise ValueError(
            f"There is no data set {name!r}. {suggest(name, dataset_names())} Subsets of train are "
            f"named like dishwasher-train-p4-d40-v{DATA_VERSION}: 1 to 7 preferences, 1 to 80 "
            "demonstrations of each; those of prompts like "
            f"dishwasher-prompts-of8-d1-v{DATA_VERSION}: one of the preferences 8 to 12, 1 to 80 "
            "demonstrations."
        )
    name = name.removeprefix(f"{NAMESPACE}/")
    if found["version"] != str(DATA_VERSION):
        right = name.removesuffix(found["version"]) + str(DATA_VERSION)
        raise ValueError(
            f"This version of kitchen_prefs makes data of version {DATA_VERSION}, so not {name!r}; "
            f"ask for {right!r}, or install the version that made the other."
        )
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


def dataset_root(name: str) -> Path:
    """The folder of a data set, in `$HF_LEROBOT_HOME` as LeRobot itself finds it."""
    # LeRobot's own rule (lerobot.utils.constants), repeated because importing it takes seconds.
    home = Path(os.environ.get("HF_LEROBOT_HOME", Path(HF_HOME) / "lerobot")).expanduser()
    return home / NAMESPACE / name


def _sessions(split: str, users: tuple[int, ...], most: int) -> tuple[tuple[str, int], ...]:
    """The first sessions of some users, user by user."""
    chosen = []
    for user in users:
        sessions = [i for i, other in enumerate(SPLITS[split].users) if other == user]
        chosen += [(split, i) for i in sessions[:most]]
    return tuple(chosen)

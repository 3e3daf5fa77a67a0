"""The file of a demonstration, which a visitor downloads from the page: a start and decisions.

    {"format": 1, "data_version": 1, "split": "prompts", "session": 412, "salt": 0,
     "decisions": [0, 2, 7, 2013, ...], "user": "Ada", "consent": true, "study": null}

It holds what the kitchen carried out and nothing that can be computed from it. A decision that the
kitchen refuses changes nothing and is not in the file: a prompt holds none either, as the expert's
decisions are never refused, and it would count in the index of the decisions that follow.
"""

import re
import unicodedata
from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, Field, StringConstraints, model_validator

from kitchen_prefs.envs.kitchen_env import MAX_EPISODE_STEPS
from kitchen_prefs.simulation.kitchen import FIRST_PLACEMENT
from kitchen_prefs.utils.files import atomic_file
from kitchen_prefs.utils.untrusted_files import Strict, parse, read_bytes
from kitchen_prefs.utils.visible_text import check_visible

FORMAT = 1  # the version of this format
MOST_BYTES = 16 * 1024  # 160 decisions of 6 characters and two names have some 1,500
MOST_INSTANCE = FIRST_PLACEMENT["top"] + 999
MOST_SALT = 2**53 - 1  # what JavaScript counts exactly

# Words of letters, digits and what stands within names: no character that HTML, a shell or a
# spreadsheet takes for its own.
WITHIN_NAMES = ".'\N{RIGHT SINGLE QUOTATION MARK}_-"
CODE = re.compile(r"[A-Za-z0-9_-]{1,60}")


def _check_person(name: str) -> str:
    for word in name.split(" "):
        kinds = [unicodedata.category(letter)[0] for letter in word]  # L letter, M mark, N digit
        fine = [
            kind in "LMN" or letter in WITHIN_NAMES
            for letter, kind in zip(word, kinds, strict=True)
        ]
        if not word or kinds[0] not in "LN" or not all(fine):
            raise ValueError("a name has words of letters, digits and . ' _ - with a space between")
    return check_visible(name)


def _check_code(code: str) -> str:
    if not CODE.fullmatch(code):
        raise ValueError("it has 1 to 60 letters, digits, '-' and '_'")
    return code


def _check_format(number: int) -> int:
    if number != FORMAT:
        raise ValueError(f"this is format {number}, and this release reads {FORMAT}")
    return number


Person = Annotated[str, StringConstraints(max_length=60), AfterValidator(_check_person)]
Code = Annotated[str, AfterValidator(_check_code)]
Instance = Annotated[int, Field(ge=0, le=MOST_INSTANCE)]


class Study(Strict):
    """The study that a demonstration was given in.

    Attributes:
        name: The study's name.
        participant: The participant's code, which names nobody.
        day: The participant's first day is 1.
    """

    name: Code
    participant: Code
    day: Annotated[int, Field(ge=1, le=365)]


class DemonstrationFile(Strict):
    """One demonstration.

    Attributes:
        format: The version of this format.
        data_version: The version of the sessions.
        split: The split of the session that it starts in.
        session: The session's index in the split.
        salt: The session seed.
        decisions: The instances that were chosen, see `kitchen_prefs.simulation.kitchen`.
        user: The user's name; None if she gave none, and in a study.
        consent: Whether the user agrees that the demonstration is kept in a data set.
        study: The study; None outside of one.
    """

    format: Annotated[int, AfterValidator(_check_format)]
    data_version: Annotated[int, Field(ge=1, le=1000)]
    split: Annotated[str, StringConstraints(pattern=r"^[a-z_]{1,40}$")]
    session: Annotated[int, Field(ge=0, le=10_000)]
    salt: Annotated[int, Field(ge=0, le=MOST_SALT)] = 0
    decisions: Annotated[list[Instance], Field(min_length=1, max_length=MAX_EPISODE_STEPS)]
    user: Person | None = None
    consent: bool = False
    study: Study | None = None

    @model_validator(mode="after")
    def _check_anonymous(self) -> "DemonstrationFile":
        if self.study and self.user:
            raise ValueError("in a study a participant has a code and no name")
        return self

    @property
    def who(self) -> str | None:
        """Who gave it: a study's participant, or a user by name; None if that is not known."""
        return f"{self.study.name}/{self.study.participant}" if self.study else self.user


def check_study_name(name: str) -> None:
    """Make sure that a study may be called so.

    Raises:
        ValueError: If not.
    """
    if not CODE.fullmatch(name):
        raise ValueError(
            f"A study's name has 1 to 60 letters, digits, '-' and '_', unlike {name!r}."
        )


def read_demonstration(file: Path) -> DemonstrationFile:
    """Read a demonstration's file, which is untrusted.

    Raises:
        ValueError: If it is missing, too large or something else.
    """
    return parse_demonstration(read_bytes(file, MOST_BYTES), str(file))


def parse_demonstration(content: bytes, where: str) -> DemonstrationFile:
    """Parse a demonstration.

    Args:
        content: The JSON.
        where: Names it in errors.

    Raises:
        ValueError: If it is something else.
    """
    return parse(DemonstrationFile, content, where)


def write_demonstration(demonstration: DemonstrationFile, file: Path) -> None:
    """Write a demonstration's file, whole or not at all."""
    with atomic_file(file) as unfinished:
        unfinished.write_text(demonstration.model_dump_json() + "\n")

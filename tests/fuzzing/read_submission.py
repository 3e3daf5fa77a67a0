"""Fuzzing of what reads a submission: whatever the files hold, it is read or refused in a sentence.

uv run --with atheris==3.1.0 python tests/fuzzing/read_submission.py -max_total_time=600

Options are libFuzzer's. An input's first byte says what the rest is: the description, lines that
are compressed before they are read, or a file of lines as it lies on the disk. What breaks the rule
is written to crash-*; given as the only argument, it is run again.
"""

import bz2
import json
import random
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import atheris
from honest import ABOUT, EPISODE

with atheris.instrument_imports(include=["kitchen_prefs_leaderboard"]):
    from kitchen_prefs.utils.untrusted_files import read_bytes
    from kitchen_prefs_leaderboard.submission_format import ACTIONS, DESCRIPTION, Line, Submission
    from kitchen_prefs_leaderboard.submission_reading import (
        MOST_COMPRESSED,
        MOST_DESCRIPTION,
        parse_description,
        parse_lines,
    )

from kitchen_prefs.splits import get_split

SPLIT = "noisy"  # the fewest sessions
MOST = 128 * 1024  # bytes of an input: twice what a description or an episode may have
MEMORY = 512  # MB, of which the interpreter and its modules have 200
LONGEST = 600  # characters of a sentence
KINDS = DESCRIPTION_ITSELF, LINES, COMPRESSED = range(3)
WORDS = [
    r"\xef\xbb\xbf", r"\x1b[2J", r"\xe2\x80\xa8", r"\xe2\x80\xae", r"\\ud800", r"\\u0000",
    "NaN", "-Infinity", "1e999", "-0.0", "5e-324", "9" * 400, "[" * 250, r"{\"a\":" * 250,
    "true", "null", "[0,0,0,0,0,0,0]", r"\"session\":", r"\"actions\":", r"BZh9",
]  # fmt: skip


def main() -> None:
    """Fuzz until libFuzzer has had enough."""
    with TemporaryDirectory() as folder:
        submission, words = Path(folder) / "submission", Path(folder) / "words"
        submission.mkdir()
        words.write_text("".join(f'"{word}"\n' for word in WORDS))
        limits = [f"-max_len={MOST}", f"-rss_limit_mb={MEMORY}", "-timeout=10"]
        atheris.Setup(
            [*sys.argv, *limits, f"-dict={words}", "-len_control=0"],
            lambda content: read(submission, content),
            custom_mutator=mutated,
        )
        atheris.Fuzz()


def mutated(content: bytes, most: int, seed: int) -> bytes:
    """An input with a few changes; every second is a well-formed one.

    What parses is compiled, and libFuzzer, which cannot see into it, would keep only short inputs.
    """
    chance = random.Random(seed)
    content = chance.choice([content, chance.choice(well_formed())])
    for _ in range(chance.randint(1, 4)):
        content = atheris.Mutate(content, most)
    return content


@cache
def well_formed() -> list[bytes]:
    """An input of each kind with which nothing is wrong."""
    about = ABOUT | {"fingerprints": {"dishwasher-seen-v1": "0" * 64}}
    sessions = range(get_split(SPLIT).sessions)
    lines = "\n".join(json.dumps(EPISODE | {"session": session}) for session in sessions).encode()
    files = {
        DESCRIPTION_ITSELF: json.dumps(about).encode(),
        LINES: lines,
        COMPRESSED: bz2.compress(lines),
    }
    return [bytes([kind]) + content for kind, content in files.items()]


def read(folder: Path, content: bytes) -> None:
    """Read one file of a submission, and hold the outcome against the rule."""
    kind, content = (content[0] % len(KINDS) if content else 0), content[1:]
    described = kind == DESCRIPTION_ITSELF
    file = folder / (DESCRIPTION if described else ACTIONS[SPLIT])
    file.write_bytes(bz2.compress(content, compresslevel=1) if kind == LINES else content)
    try:
        if described:
            found = parse_description(read_bytes(file, MOST_DESCRIPTION), file)
        else:
            found = parse_lines(read_bytes(file, MOST_COMPRESSED), SPLIT, file)
    except ValueError as error:
        check_sentence(str(error), file)
    else:
        check_found(found)


def check_sentence(sentence: str, file: Path) -> None:
    """One line that a terminal can show, and that names the file."""
    assert sentence.startswith(str(file)), sentence
    assert sentence.isprintable(), sentence
    assert len(sentence) < LONGEST, sentence


def check_found(found: Submission | list[Line]) -> None:
    """What was read is what the format says, once more."""
    if isinstance(found, Submission):
        assert Submission.model_validate(found.model_dump()) == found
        return
    assert [line.session for line in found] == list(range(get_split(SPLIT).sessions))
    assert all(Line.model_validate(line.model_dump()) == line for line in found)


if __name__ == "__main__":
    main()

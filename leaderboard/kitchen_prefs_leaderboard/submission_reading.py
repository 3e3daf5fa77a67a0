"""Reading a submission as what it is: files from a stranger.

Nothing is followed (no links), nothing is read beyond its bound, nothing is executed, and what is
wrong is said in one sentence.
"""

import errno
import os
import stat
from bz2 import BZ2Decompressor
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel, ValidationError

from kitchen_prefs.splits import get_split
from kitchen_prefs_leaderboard.submission_format import (
    ACTIONS,
    DESCRIPTION,
    Line,
    Submission,
    complaint,
)

MOST_DESCRIPTION = 64 * 1024  # bytes; ours have some 2,000
MOST_COMPRESSED = 1024 * 1024  # bytes of one split; ours have some 100,000
# Bytes of one split before compression. The largest split, 210 episodes of 160 decisions, each
# written in 80 characters, has 2.7 million.
MOST_LINES = 4 * 1024 * 1024
# Bytes of one episode: 160 actions of 7 numbers, each of at most 25 characters, have 28,000. Every
# mistake in it is noted, which takes up to 150 times its size.
MOST_LINE = 64 * 1024


def read_description(folder: Path) -> Submission:
    """Read who acted.

    Raises:
        ValueError: If `submission.json` is not there or is no `Submission`.
    """
    file = folder / DESCRIPTION
    return _parse(Submission, _bytes_of(file, MOST_DESCRIPTION), str(file))


def read_lines(folder: Path, split: str) -> list[Line]:
    """Read what was done on a split, every session once and in order.

    Raises:
        ValueError: If the file is not there, is too large, or holds anything else.
    """
    file = folder / ACTIONS[split]
    text = _decompress(_bytes_of(file, MOST_COMPRESSED), file)
    lines = [
        _line(line, f"{file}, line {number}")
        for number, line in enumerate(text.splitlines(), start=1)
    ]
    for index, line in enumerate(lines):
        if line.session != index:
            raise ValueError(
                f"{file}, line {index + 1} is session {line.session}; each session stands there "
                "once, in order from 0."
            )
    wanted = get_split(split).sessions
    if len(lines) != wanted:
        raise ValueError(f"{file} has {len(lines)} episodes; {split} has {wanted} sessions.")
    return lines


def files_of(folder: Path) -> Iterator[tuple[str, bytes]]:
    """The name and the content of each of a submission's files.

    Raises:
        ValueError: If one is missing or too large.
    """
    yield DESCRIPTION, _bytes_of(folder / DESCRIPTION, MOST_DESCRIPTION)
    for name in ACTIONS.values():
        yield name, _bytes_of(folder / name, MOST_COMPRESSED)


def _bytes_of(file: Path, most: int) -> bytes:
    """A regular file's content, of at most so many bytes."""
    try:
        with open(file, "rb", opener=_open) as opened:
            if not stat.S_ISREG(os.fstat(opened.fileno()).st_mode):
                raise ValueError(f"{file} is not a regular file.")
            content = opened.read(most + 1)
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise ValueError(f"{file} is a link; a submission holds files.") from error
        raise ValueError(f"{file} cannot be read: {error.strerror}.") from error
    if len(content) > most:
        raise ValueError(f"{file} is larger than {most:,} bytes.")
    return content


def _open(file: str, flags: int) -> int:
    """A link is not followed; a pipe is not waited for."""
    return os.open(file, flags | os.O_NOFOLLOW | os.O_NONBLOCK)


def _decompress(content: bytes, file: Path) -> bytes:
    stream = BZ2Decompressor()
    try:
        text = stream.decompress(content, MOST_LINES + 1)
    except OSError as error:
        raise ValueError(f"{file} is not a bzip2 file, or a damaged one.") from error
    if len(text) > MOST_LINES:
        raise ValueError(f"{file} holds more than {MOST_LINES:,} bytes.")
    if not stream.eof or stream.unused_data:
        raise ValueError(f"{file} is not one whole bzip2 file.")
    return text


def _line(content: bytes, where: str) -> Line:
    if len(content) > MOST_LINE:
        raise ValueError(f"{where} is longer than {MOST_LINE:,} bytes.")
    return _parse(Line, content, where)


def _parse[Model: BaseModel](model: type[Model], content: bytes, where: str) -> Model:
    try:
        return model.model_validate_json(content)
    except ValidationError as error:
        raise ValueError(f"{where} is not what the format says: {complaint(error)}") from error

"""Reads a submission, whose files are untrusted.

No link is followed, nothing is read beyond its size limit, nothing is executed, and an error is one
sentence.
"""

import hashlib
from bz2 import BZ2Decompressor
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kitchen_prefs.evaluation.tiers import Tier, tier_of
from kitchen_prefs.utils.untrusted_files import parse, read_bytes
from kitchen_prefs_leaderboard.submission_format import (
    ACTIONS,
    DESCRIPTION,
    Line,
    Submission,
)

MOST_DESCRIPTION = 64 * 1024  # bytes; ours have some 2,000
MOST_COMPRESSED = 1024 * 1024  # bytes of one split; ours have some 100,000
# Bytes of one split before compression. The largest split, 210 episodes of 160 decisions, each
# written in 80 characters, has 2.7 million.
MOST_LINES = 4 * 1024 * 1024
# Bytes of one episode: 160 actions of 7 numbers, each of at most 25 characters, have 28,000.
# Pydantic collects every error in it, which takes up to 150 times its size.
MOST_LINE = 64 * 1024


@dataclass(frozen=True)
class SubmissionFiles:
    """The files of a submission, read once.

    It holds the files' bytes, about 600,000 of an honest submission, and parses the lines of a
    split on demand: parsed, they need fifty times the memory.

    Attributes:
        folder: The submission's folder.
        description: The submission's description, parsed.
        contents: Each file's bytes, by its name.
    """

    folder: Path
    description: Submission
    contents: Mapping[str, bytes]

    def lines(self, split: str) -> list[Line]:
        """Parse the episodes of a split: every session once and in order.

        Raises:
            ValueError: If the file is too large, or holds anything else.
        """
        name = ACTIONS[split]
        return parse_lines(self.contents[name], split, self.folder / name)

    @property
    def splits(self) -> list[str]:
        """The test splits of the tiers that it covers."""
        return [split for tier in self.description.tiers for split in tier.test_splits]

    def digest(self, tier: Tier) -> str:
        """A hash of the description and of a tier's files."""
        sha = hashlib.sha256()
        for name in (DESCRIPTION, *(ACTIONS[split] for split in tier.test_splits)):
            content = self.contents[name]
            sha.update(f"{name} {len(content)}\n".encode())
            sha.update(content)
        return sha.hexdigest()


def read_submission(folder: Path) -> SubmissionFiles:
    """Read a submission's files, each within its size limit; the description is parsed first.

    Raises:
        ValueError: If a file is missing or too large, or if `submission.json` is no `Submission`.
    """
    content = read_bytes(folder / DESCRIPTION, MOST_DESCRIPTION)
    description = parse_description(content, folder / DESCRIPTION)
    contents = {DESCRIPTION: content}
    for tier in description.tiers:
        for name in (ACTIONS[split] for split in tier.test_splits):
            contents[name] = read_bytes(folder / name, MOST_COMPRESSED)
    return SubmissionFiles(folder, description, contents)


def parse_description(content: bytes, file: Path) -> Submission:
    """Parse `submission.json`.

    Raises:
        ValueError: If it is no `Submission`; the message names the file.
    """
    return parse(Submission, content, str(file))


def parse_lines(content: bytes, split: str, file: Path) -> list[Line]:
    """Decompress and parse the episodes of a split: every session once and in order.

    Raises:
        ValueError: If they are too large, or anything else; the message names the file.
    """
    text = _decompress(content, file)
    lines = [
        _line(line, f"{file}, line {number}")
        for number, line in enumerate(text.splitlines(), start=1)
    ]
    for index, line in enumerate(lines):
        if line.session != index:
            raise ValueError(
                f"{file}, line {index + 1} is session {line.session}; each session appears once, "
                "in order from 0."
            )
    wanted = tier_of(split).sessions(split)
    if len(lines) != wanted:
        raise ValueError(f"{file} has {len(lines)} episodes; {split} has {wanted} sessions.")
    return lines


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
    return parse(Line, content, where)

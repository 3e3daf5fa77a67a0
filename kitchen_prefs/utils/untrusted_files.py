"""Reads files of strangers: within a size limit, into a model, and an error is one sentence.

No link is followed, nothing is executed.
"""

import errno
import os
import stat
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError


class Strict(BaseModel):
    """A model without extra fields, type conversion or infinite numbers."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


def read_bytes(file: Path, most: int) -> bytes:
    """Read a regular file of at most so many bytes.

    Raises:
        ValueError: If it is missing, larger, or not a regular file.
    """
    try:
        with open(file, "rb", opener=_open) as opened:
            if not stat.S_ISREG(os.fstat(opened.fileno()).st_mode):
                raise ValueError(f"{file} is not a regular file.")
            content = opened.read(most + 1)
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise ValueError(f"{file} is a link; give the file itself.") from error
        raise ValueError(f"{file} cannot be read: {error.strerror}.") from error
    if len(content) > most:
        raise ValueError(f"{file} is larger than {most:,} bytes.")
    return content


def parse[Model: BaseModel](model: type[Model], content: bytes, where: str) -> Model:
    """Parse JSON.

    Args:
        model: What it is.
        content: The JSON.
        where: Names it in errors.

    Raises:
        ValueError: If it is no such model.
    """
    try:
        return model.model_validate_json(content)
    except ValidationError as error:
        raise ValueError(f"{where} does not follow the format: {complaint(error)}") from error


def complaint(error: ValidationError) -> str:
    """The first validation error, in a few printable words."""
    first = error.errors(include_url=False, include_input=False)[0]
    at = ".".join(str(step)[:40] for step in first["loc"][:6])
    message = first["msg"].removeprefix("Value error, ")[:200]
    words = f"{f'{at}: ' if at else ''}{message}."
    # The name of an extra field is untrusted.
    return "".join(character if character.isprintable() else "?" for character in words)


def _open(file: str, flags: int) -> int:
    """A link is not followed; a pipe is not waited for."""
    return os.open(file, flags | os.O_NOFOLLOW | os.O_NONBLOCK)

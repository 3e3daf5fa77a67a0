"""Files and folders that are written atomically, and folders that can be written to."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import rmtree
from tempfile import TemporaryFile

from filelock import FileLock, Timeout


@contextmanager
def atomic_file(path: Path) -> Iterator[Path]:
    """Write a file beside its place first, and move it there once all is written.

    Args:
        path: The file's place; what is there stays until the new file is whole.

    Yields:
        The path to write to, with the same suffix.
    """
    unfinished = path.with_name(f".unfinished-{path.name}")
    try:
        yield unfinished
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


@contextmanager
def atomic_folder(path: Path) -> Iterator[Path]:
    """Write a folder beside its place first, and move it there once all is written.

    Args:
        path: The folder's place; what is there stays until the new folder is whole.

    Yields:
        The folder to write to, which is empty.
    """
    unfinished = path.with_name(f".unfinished-{path.name}")
    before = path.with_name(f".before-{path.name}")
    rmtree(unfinished, ignore_errors=True)  # of a process that was killed
    unfinished.mkdir(parents=True)
    try:
        yield unfinished
        if path.exists():
            path.replace(before)
        unfinished.replace(path)
    finally:
        rmtree(unfinished, ignore_errors=True)
        rmtree(before, ignore_errors=True)


def write_json(path: Path, content: dict) -> None:
    """Write a JSON file so that it is either whole or not there."""
    with atomic_file(path) as unfinished:
        unfinished.write_text(json.dumps(content, indent=2) + "\n")


def make_folder(path: Path, option: str) -> None:
    """Make a folder if it is not there, and make sure that it can be written.

    Args:
        path: The folder.
        option: The option of the command line that named it.

    Raises:
        OSError: If it cannot be made or written.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=path):
            pass
    except OSError as error:
        raise OSError(f"{path} cannot be written; give another {option}.") from error


def require_empty(path: Path, option: str) -> None:
    """Make sure that a folder that will be written is not there yet, or is empty.

    Args:
        path: The folder.
        option: The option of the command line that named it.

    Raises:
        ValueError: If it holds something, or is a file.
    """
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise ValueError(f"{path} holds something already; give another {option}.")


@contextmanager
def at_work_alone(path: Path) -> Iterator[None]:
    """Hold a file or folder, so that two commands do not write it at once.

    The lock lies beside it; it ends with the process.

    Args:
        path: What is written.

    Raises:
        ValueError: If another command holds it.
    """
    try:
        with FileLock(path.with_name(f".{path.name}.lock"), timeout=0):
            yield
    except Timeout as error:
        raise ValueError(
            f"Another command is at work on {path}; wait until it ends, or give another --out."
        ) from error

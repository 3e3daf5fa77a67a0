"""Messages between an evaluation and the process of a policy.

A message is the length of its head (4 bytes, big-endian), the head in JSON, and the bytes of the
arrays that the head lists. Nothing is unpickled on either side, and a reader bounds what it takes.
"""

import json
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np

LENGTH = 4  # bytes of the length of a head
MOST_HEAD = 64 * 1024  # bytes; the tasks of 16 environments in words have 5,000


class PipeClosedError(Exception):
    """The other side has closed the pipe, or has sent something else than a message."""


def send(stream: BinaryIO, arrays: Mapping[str, np.ndarray] | None = None, **head: Any) -> None:
    """Write a message.

    Args:
        stream: The pipe.
        arrays: Arrays of float32.
        **head: What JSON can hold.
    """
    arrays = {name: np.ascontiguousarray(a, np.float32) for name, a in (arrays or {}).items()}
    shapes = {name: array.shape for name, array in arrays.items()}
    encoded = json.dumps({"head": head, "shapes": shapes}).encode()
    stream.write(len(encoded).to_bytes(LENGTH, "big") + encoded)
    for array in arrays.values():
        stream.write(array.data)
    stream.flush()


def receive(stream: BinaryIO, most: int) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Read a message.

    Args:
        stream: The pipe.
        most: How many bytes its arrays may have.

    Returns:
        The head and the arrays.

    Raises:
        PipeClosedError: If the pipe ends, or if something else comes than such a message.
    """
    length = int.from_bytes(_read(stream, LENGTH), "big")
    if length > MOST_HEAD:
        raise PipeClosedError
    try:
        message = json.loads(_read(stream, length))
        head, shapes = dict(message["head"]), dict(message["shapes"])
        shapes = {name: tuple(int(side) for side in shape) for name, shape in shapes.items()}
    except (ValueError, KeyError, TypeError) as error:
        raise PipeClosedError from error
    sizes = {name: _size(shape) for name, shape in shapes.items()}
    if not 0 <= sum(sizes.values()) <= most or min(sizes.values(), default=0) < 0:
        raise PipeClosedError
    arrays = {
        name: np.frombuffer(_read(stream, size), np.float32).reshape(shapes[name])
        for name, size in sizes.items()
    }
    return head, arrays


def _size(shape: tuple[int, ...]) -> int:
    """The bytes of an array of float32; negative if a side is."""
    size = np.dtype(np.float32).itemsize
    for side in shape:
        if side < 0:
            return -1
        size *= side
    return size


def _read(stream: BinaryIO, size: int) -> bytes:
    content = stream.read(size)
    if len(content) < size:
        raise PipeClosedError
    return content

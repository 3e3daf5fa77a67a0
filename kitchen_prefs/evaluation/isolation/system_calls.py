"""System calls that the kernel refuses to a policy's process (Linux's seccomp).

The process starts no other, so that the bound on its memory bounds all that it takes; threads share
that memory. It opens no socket, of the network or on the disk.
"""

import errno
import platform
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from tempfile import TemporaryFile


@dataclass(frozen=True)
class Architecture:
    """The numbers of a processor's system calls, from the kernel's headers (asm/unistd.h).

    Attributes:
        audit: The architecture's own number (linux/audit.h).
        clone: The call that starts threads and processes.
        refused: `socket`, `unshare`, `io_uring_setup` and, where it has them, `fork` and `vfork`.
    """

    audit: int
    clone: int
    refused: tuple[int, ...]


ARCHITECTURES = {
    "x86_64": Architecture(0xC000003E, 56, (41, 272, 425, 57, 58)),
    "aarch64": Architecture(0xC00000B7, 220, (198, 97, 425)),
}
CLONE3 = 435  # its arguments cannot be read here; libraries fall back to clone if it is not there
CLONE_THREAD = 0x00010000
X32_CALLS = 0x40000000  # calls of a second kind on x86_64 begin here
# struct seccomp_data: the call, the architecture, the instruction's address (8), the arguments.
CALL_AT, ARCHITECTURE_AT, FIRST_ARGUMENT_AT = 0, 4, 16
# Instructions of a BPF program (linux/bpf_common.h): code, and what it does with its number.
LOAD, EQUAL, AT_LEAST, HAS_BIT, RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
ALLOW, REFUSE, KILL = 0x7FFF0000, 0x00050000, 0x80000000


@contextmanager
def system_call_filter() -> Iterator[int]:
    """A file with the filter for this processor, which `bwrap --seccomp` reads; its descriptor.

    It is empty on processors that are not among `ARCHITECTURES`, and bubblewrap refuses that.
    """
    architecture = ARCHITECTURES.get(platform.machine())
    with TemporaryFile() as file:
        file.write(_program(architecture) if architecture else b"")
        file.seek(0)
        yield file.fileno()


def _program(architecture: Architecture) -> bytes:
    """A BPF program that judges one system call."""
    refuse = _instruction(RETURN, REFUSE | errno.EPERM)
    return b"".join(
        [
            _instruction(LOAD, ARCHITECTURE_AT),
            _instruction(EQUAL, architecture.audit, if_true=1),
            _instruction(RETURN, KILL),
            _instruction(LOAD, CALL_AT),
            _instruction(AT_LEAST, X32_CALLS, if_false=1),
            _instruction(RETURN, KILL),
            *(
                line
                for call in architecture.refused
                for line in (_instruction(EQUAL, call, if_false=1), refuse)
            ),
            _instruction(EQUAL, CLONE3, if_false=1),
            _instruction(RETURN, REFUSE | errno.ENOSYS),
            _instruction(EQUAL, architecture.clone, if_false=3),
            _instruction(LOAD, FIRST_ARGUMENT_AT),
            _instruction(HAS_BIT, CLONE_THREAD, if_true=1),
            refuse,
            _instruction(RETURN, ALLOW),
        ]
    )


def _instruction(code: int, number: int, *, if_true: int = 0, if_false: int = 0) -> bytes:
    """One instruction; a comparison skips so many of the next ones if it is true or false."""
    return struct.pack("=HBBI", code, if_true, if_false, number)

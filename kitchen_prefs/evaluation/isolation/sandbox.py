"""How the platform confines a policy's process.

On Linux with bubblewrap the process has a root of its own: it sees Python, the packages, the
checkpoint and nothing else of the disk, and can write to a scratch folder in memory alone. It has
no network, sees no other process, and cannot start one. Elsewhere it is only a process of its own,
and `warn_without_sandbox` says so.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from functools import lru_cache
from pathlib import Path
from tempfile import gettempdir
from typing import Any

from kitchen_prefs.evaluation.isolation.system_calls import system_call_filter
from kitchen_prefs.utils.processes import ending_with_this

NO_SANDBOX = (
    "This platform confines no process (bubblewrap 0.7 or newer on Linux, where users may make "
    "namespaces), so the policy's process can read files and use the network; run policies of "
    "strangers elsewhere."
)
# Variables that the process keeps: where programs, libraries and plug-ins are, and nothing else.
KEPT_VARIABLES = ("PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "VIRTUAL_ENV", "LANG")
# The system's programs and libraries, how they are found, and the names of users.
SYSTEM = (
    *("/usr", "/bin", "/lib", "/lib64", "/nix/store"),
    *("/etc/ld.so.cache", "/etc/alternatives", "/etc/localtime", "/etc/passwd"),
)
SCRATCH_BYTES = 256 * 1024 * 1024


@lru_cache
def has_sandbox() -> bool:
    """Whether this platform can confine a process."""
    if not (sys.platform == "linux" and shutil.which("bwrap")):
        return False
    process = start_confined(["true"], Path(gettempdir()), stderr=subprocess.DEVNULL, confine=True)
    return process.wait() == 0


def warn_without_sandbox() -> None:
    """Say where this platform cannot confine a process."""
    if not has_sandbox():
        print(NO_SANDBOX, file=sys.stderr)


def start_confined(
    command: Sequence[str],
    scratch: Path,
    *,
    readable: Iterable[Path] = (),
    hidden: Iterable[Path] = (),
    confine: bool | None = None,
    **popen: Any,
) -> subprocess.Popen:
    """Start a command in the sandbox, or as it is where there is none; it ends with this process.

    Args:
        command: The command.
        scratch: The one folder that it may write to, in memory and seen by it alone, so that
            policies in several processes cannot exchange what they observe.
        readable: Folders that it needs beside Python and the packages.
        hidden: Folders that it must not see though they lie in those that it sees.
        confine: Whether to confine it; if not given, where this platform can.
        **popen: More arguments of `subprocess.Popen`.
    """
    if not (has_sandbox() if confine is None else confine):
        return subprocess.Popen(ending_with_this(command), cwd=scratch, **popen)
    with system_call_filter() as descriptor:
        bubblewrap = [
            *("bwrap", "--unshare-all", "--die-with-parent", "--as-pid-1", "--cap-drop", "ALL"),
            *("--seccomp", str(descriptor)),
            *_mounts(_visible(readable), [one.resolve() for one in hidden], scratch.resolve()),
        ]
        return subprocess.Popen([*bubblewrap, *command], pass_fds=[descriptor], **popen)


def _mounts(visible: Iterable[Path], hidden: Iterable[Path], scratch: Path) -> list[str]:
    """Options of bubblewrap that lay out the root; later ones cover earlier ones."""
    read_only = [option for one in visible for option in ("--ro-bind", str(one), str(one))]
    covered = [
        option for one in hidden for option in ("--tmpfs", str(one), "--remount-ro", str(one))
    ]
    devices = [
        option
        for one in Path("/dev").glob("nvidia*")
        for option in ("--dev-bind", str(one), str(one))
    ]
    return [
        *("--proc", "/proc", "--dev", "/dev", *devices, "--remount-ro", "/dev"),
        *read_only,
        *covered,
        *("--size", str(SCRATCH_BYTES), "--tmpfs", str(scratch), "--chdir", str(scratch)),
        *("--remount-ro", "/"),
    ]


def _visible(readable: Iterable[Path]) -> list[Path]:
    """What the process sees: the system, Python, what it imports from, and what it is given.

    Outer folders come first, as they would cover inner ones.
    """
    imported_from = map(Path, sys.path[1:])  # the first is the folder of this program alone
    wanted = [*map(Path, SYSTEM), Path(sys.prefix), Path(sys.base_prefix), *imported_from]
    for folder in readable:
        wanted += [folder, *_blobs(folder)]
    places = {place for one in wanted for place in (one.absolute(), one.resolve())}
    return sorted(place for place in places if place.exists())


def _blobs(folder: Path) -> list[Path]:
    """Where the files of a checkpoint are if it lies in the hub's cache, whose snapshots are links.

    Other links are not followed: they may lead to files that are none of the policy's business.
    """
    repository = folder.resolve().parent.parent
    blobs = repository / "blobs"
    in_cache = folder.resolve().parent.name == "snapshots" and not blobs.is_symlink()
    return [blobs] if in_cache else []


def scrubbed_environment(scratch: Path, plugins: Path | None = None) -> dict[str, str]:
    """The variables of the process: no tokens, no paths of the evaluation, one thread.

    Args:
        scratch: The folder that it may write to.
        plugins: A folder of packages that this process alone imports from.
    """
    kept = {name: os.environ[name] for name in KEPT_VARIABLES if name in os.environ}
    if plugins:
        folders = [str(plugins.resolve()), kept.get("PYTHONPATH", "")]
        kept["PYTHONPATH"] = os.pathsep.join(filter(None, folders))
    return kept | {
        "HOME": str(scratch),
        "TMPDIR": str(scratch),
        "HF_HOME": str(scratch),
        "HF_HUB_OFFLINE": "1",
        "OMP_NUM_THREADS": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
    }

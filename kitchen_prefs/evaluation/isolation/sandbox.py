"""How the platform confines a policy's process.

On Linux where users may make namespaces, the process has no network, sees no other process, can
write to its scratch folder alone, and does not see folders that are hidden from it, `/run` among
them. It can read the rest of the disk, and open sockets that lie there. Elsewhere it is only a
process of its own, and `NO_SANDBOX` says so.
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

from kitchen_prefs.utils.processes import ending_with_this

NO_SANDBOX = (
    "This platform gives no namespaces (`unshare` and `setpriv` of util-linux on Linux), so the "
    "policy's process can read files and use the network; run policies of strangers elsewhere."
)
# Variables that the process keeps: where programs, libraries and plug-ins are, and nothing else.
KEPT_VARIABLES = ("PATH", "PYTHONPATH", "LD_LIBRARY_PATH", "VIRTUAL_ENV", "LANG")
NAMESPACES = (
    *("unshare", "--user", "--map-root-user", "--net", "--ipc", "--uts", "--mount"),
    *("--pid", "--fork", "--kill-child", "--mount-proc"),
)
SERVICES = (Path("/run"),)  # their sockets are files, which a process without a network may open
# Arguments: the scratch folder, hidden folders, --, the command. The scratch folder is in memory
# and seen by this process alone, so that policies in several processes cannot exchange what they
# observe. Every other mount becomes read-only; without capabilities the command cannot undo it.
CONFINE = """
scratch=$1; shift
mount -t tmpfs -o size=256m none "$scratch" && cd "$scratch" || exit 125
while [ "$1" != -- ]; do mount -t tmpfs -o size=4k none "$1" || exit 125; shift; done
shift
while read -r _ _ _ _ point options _; do
    case $point in "$scratch" | /proc) continue ;; esac
    kept=$(echo "$options" | tr , '\\n' | grep -E 'nosuid|nodev|noexec|atime' | paste -sd,)
    mount -o "remount,bind,ro${kept:+,$kept}" "$point" 2>/dev/null
done < /proc/self/mountinfo
exec setpriv --no-new-privs --inh-caps=-all --bounding-set=-all "$@"
"""


@lru_cache
def has_sandbox() -> bool:
    """Whether this platform can confine a process."""
    if not (sys.platform == "linux" and shutil.which("unshare") and shutil.which("setpriv")):
        return False
    return subprocess.run([*NAMESPACES, "true"], capture_output=True, check=False).returncode == 0


def confined(command: Sequence[str], scratch: Path, hidden: Sequence[Path]) -> list[str]:
    """A command as it is run in the sandbox, or as it is where there is none.

    Args:
        command: The command.
        scratch: The one folder that it may write to.
        hidden: Folders that it must not see; they exist.
    """
    if not has_sandbox():
        return ending_with_this(command)
    services = [folder for folder in SERVICES if folder.is_dir()]
    folders = [str(folder.resolve()) for folder in (scratch, *hidden, *services)]
    return ending_with_this([*NAMESPACES, "sh", "-c", CONFINE, "sh", *folders, "--", *command])


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

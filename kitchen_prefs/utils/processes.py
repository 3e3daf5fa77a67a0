"""Another command, run with a progress bar and a log."""

import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from tqdm import tqdm

# What tqdm prints: "Training:   5%|▌         | 50/1000 [00:12<03:50,  4.12step/s]".
BAR = re.compile(r"[\w-]+: +\d+%\|.*?\| *\d+/\d+ \[.*?\]")

# The loader works beside the training. Two threads that wait for each other on a core that a third
# process wants took ten times as long.
ONE_THREAD = {"OMP_NUM_THREADS": "1"}


def run_module(module: str, arguments: Sequence[str], log: Path, name: str) -> None:
    """Run `python -m MODULE ARGUMENTS` in one thread.

    Args:
        module: Such as "kitchen_prefs.cli".
        arguments: What the module is told.
        log: What the command says is appended to it, except its bars.
        name: Stands before the command's own bars, which are shown in a line of their own.

    Raises:
        OSError: If the command fails; the message names the log.
    """
    process = start([sys.executable, "-m", module, *arguments])
    assert process.stdout is not None
    with log.open("a") as file, tqdm(desc=name, bar_format="{desc}", leave=False) as bar:
        for line in process.stdout:  # a carriage return ends a line too
            if shown := BAR.search(line):
                bar.set_description_str(f"{name}, {shown.group()}")
            if said := BAR.sub("", line).rstrip():  # what is logged follows on the bar's line
                file.write(f"{said}\n")
                file.flush()
    if process.wait() != 0:
        raise OSError(f"{module} failed; the end of {log} says why.")


def start(command: list[str]) -> subprocess.Popen[str]:
    """Start a command in one thread; all that it says comes out of one pipe."""
    return subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=os.environ | ONE_THREAD,
    )

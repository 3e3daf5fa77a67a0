"""Python modules run in processes of their own, with a progress bar and a log."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from tqdm import tqdm

# What tqdm prints: "Training:   5%|▌         | 50/1000 [00:12<03:50,  4.12step/s]".
PROGRESS_BAR = re.compile(r"[\w-]+: +\d+%\|.*?\| *\d+/\d+ \[.*?\]")

# A data loader works beside a training. With two threads each they compete for the cores: steps
# took ten times as long when a third process was busy on one of two cores.
ONE_THREAD = {"OMP_NUM_THREADS": "1"}


def ending_with_this(command: Sequence[str]) -> list[str]:
    """A command whose process ends when this one does, even if it is killed (Linux alone)."""
    if shutil.which("setpriv") is None:
        return list(command)
    return ["setpriv", "--pdeathsig", "KILL", *command]


def run_module(module: str, arguments: Sequence[str], log: Path, title: str) -> None:
    """Run `python -P -m MODULE ARGUMENTS` in one thread, and show the progress bar that it prints.

    With -P nothing is imported from the current folder, where a stranger's files may lie. The
    process ends with this one.

    Args:
        module: Such as "kitchen_prefs.cli".
        arguments: The module's arguments.
        log: Its output is appended to this file, except for progress bars.
        title: Stands before the module's progress bar.

    Raises:
        OSError: If the module fails; the message names the log.
    """
    process = subprocess.Popen(
        ending_with_this([sys.executable, "-P", "-m", module, *arguments]),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,  # so that a carriage return, which ends a bar's line, ends a line here, too
        errors="replace",
        env=os.environ | ONE_THREAD,
    )
    assert process.stdout is not None
    with log.open("a") as file, tqdm(desc=title, bar_format="{desc}", leave=False) as bar:
        for line in process.stdout:
            if progress := PROGRESS_BAR.search(line):
                bar.set_description_str(f"{title}, {progress.group()}")
            # A log entry may follow on the bar's own line.
            if text := PROGRESS_BAR.sub("", line).rstrip():
                file.write(f"{text}\n")
                file.flush()
    if process.wait() != 0:
        raise OSError(f"{module} failed; the end of {log} says why.")

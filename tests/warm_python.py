"""A Python that starts in a second: its processes are forked from one that has imported torch.

A fresh one takes four seconds to import what LeRobot needs, and the tests start dozens. LeRobot,
`datasets` and `huggingface_hub` are not imported beforehand: they read the environment when they
are. With the extras, torch-geometric imports the last of them, and is not imported either.
"""

import multiprocessing
import os
import runpy
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

import pytest

SLOW_TO_IMPORT = [
    *("torch", "torch._dynamo", "torch.distributed", "torchvision"),
    *("pandas", "pyarrow.dataset", "scipy.spatial.transform", "stable_baselines3", "av"),
    *(() if find_spec("transformers") else ("torch_geometric.nn",)),
]

_context = multiprocessing.get_context("forkserver")
_context.set_forkserver_preload(SLOW_TO_IMPORT)


def run(*arguments, cwd=None, env=None):
    """Run `python ARGUMENTS`, as subprocess.run does with captured text.

    Args:
        arguments: "-m" and a module or "-c" and a program, and what either is given.
        cwd: The folder it runs in.
        env: Its environment; that of this process by default.
    """
    with tempfile.TemporaryDirectory() as folder:
        outputs = [Path(folder) / name for name in ("stdout", "stderr")]
        where = (str(cwd or os.getcwd()), dict(os.environ if env is None else env))
        # Given names of files, as a forked process has none of the descriptors of this one.
        process = _context.Process(target=_run, args=(list(map(str, arguments)), *where, outputs))
        with pytest.MonkeyPatch.context() as patch:
            # The first start starts the server, which no path of a test's programs may change.
            patch.delenv("PYTHONPATH", raising=False)
            process.start()
        process.join()
        stdout, stderr = (path.read_text(errors="replace") for path in outputs)
    return subprocess.CompletedProcess(arguments, process.exitcode, stdout, stderr)


def _run(arguments, cwd, env, outputs):
    for descriptor, path in zip((1, 2), outputs, strict=True):
        os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT), descriptor)
    multiprocessing.set_start_method(None, force=True)  # a fresh Python's, not this one's
    os.chdir(cwd)
    os.environ.clear()
    os.environ.update(env)
    path = [folder for folder in env.get("PYTHONPATH", "").split(os.pathsep) if folder]
    sys.path[:0] = [cwd, *path]  # as Python does for -m and -c
    for customisation in (Path(folder) / "sitecustomize.py" for folder in path):
        if customisation.exists():
            runpy.run_path(str(customisation))
    how, what, *sys.argv[1:] = arguments
    if how == "-m":
        runpy.run_module(what, run_name="__main__", alter_sys=True)
    else:
        exec(what, {"__name__": "__main__"})

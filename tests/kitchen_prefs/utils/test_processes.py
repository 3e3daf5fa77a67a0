"""Modules run in processes of their own: their bars, their logs, their failures."""

import os
import shutil
import signal
import subprocess
import sys
import time

import pytest

from kitchen_prefs.utils.processes import run_module

BAR = "Training:   5%|▌         | 50/1000 [00:12<03:50,  4.12step/s]"
ENTRY = "INFO step:50 loss:2.107"


def test_a_module_that_fails_names_its_log(tmp_path):
    log = tmp_path / "evaluate.log"
    arguments = ["evaluate", "--split=nonsense", f"--out={tmp_path}"]
    with pytest.raises(OSError, match=r"evaluate\.log says why"):
        run_module("kitchen_prefs.cli", arguments, log, "nonsense")
    assert "There is no split 'nonsense'" in log.read_text()


def test_the_log_keeps_what_stands_beside_the_bar_and_the_bar_is_shown(
    tmp_path, monkeypatch, capfd
):
    script = f"print({BAR!r} + {ENTRY!r}); print({BAR!r}, end='\\r'); print('end')"
    (tmp_path / "talkative.py").write_text(script)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    log = tmp_path / "train.log"
    log.write_text("before\n")
    run_module("talkative", [], log, "training")
    assert log.read_text().splitlines() == ["before", ENTRY, "end"]
    assert f"training, {BAR}" in capfd.readouterr().err


def test_a_module_runs_in_one_thread(tmp_path, monkeypatch):
    (tmp_path / "threads.py").write_text("import os; print(os.environ['OMP_NUM_THREADS'])")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("OMP_NUM_THREADS", "4")
    run_module("threads", [], tmp_path / "log", "threads")
    assert (tmp_path / "log").read_text() == "1\n"


def test_nothing_is_imported_from_the_current_folder(tmp_path, monkeypatch):
    (tmp_path / "here").mkdir()
    for name in ("lerobot_policy_stranger", "stranger"):
        (tmp_path / "here" / f"{name}.py").write_text("print('BREACH')")
    about = tmp_path / "here" / "lerobot_policy_stranger-1.dist-info"
    about.mkdir()
    metadata = ("Metadata-Version: 2.1", "Name: lerobot_policy_stranger", "Version: 1", "")
    (about / "METADATA").write_text("\n".join(metadata))
    monkeypatch.chdir(tmp_path / "here")
    log = tmp_path / "log"
    with pytest.raises(OSError, match="stranger failed"):
        run_module("stranger", [], log, "stranger")
    program = "import importlib.metadata as m; print([d.name for d in m.distributions()])"
    (tmp_path / "listing.py").write_text(program)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    run_module("listing", [], log, "listing")
    assert "BREACH" not in log.read_text()
    assert "lerobot_policy_stranger'" not in log.read_text()


@pytest.mark.skipif(shutil.which("setpriv") is None, reason="needs util-linux")
def test_a_module_ends_with_the_process_that_runs_it(tmp_path):
    (tmp_path / "sleeper.py").write_text(
        "import os, pathlib, time\n"
        f"pathlib.Path({str(tmp_path / 'pid')!r}).write_text(str(os.getpid()))\n"
        "time.sleep(3600)\n"
    )
    program = (
        "from pathlib import Path\n"
        "from kitchen_prefs.utils.processes import run_module\n"
        f"run_module('sleeper', [], Path({str(tmp_path / 'log')!r}), 'Sleeping')\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program],
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        stderr=subprocess.DEVNULL,
    ) as parent:
        until(lambda: (tmp_path / "pid").exists() and (tmp_path / "pid").read_text())
        parent.send_signal(signal.SIGKILL)
    sleeper = int((tmp_path / "pid").read_text())
    until(lambda: not os.path.exists(f"/proc/{sleeper}"))


def until(something):
    for _ in range(300):
        if something():
            return
        time.sleep(0.1)
    raise AssertionError("it does not happen")

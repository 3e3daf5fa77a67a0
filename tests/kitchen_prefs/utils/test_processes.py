"""Modules run in processes of their own: their bars, their logs, their failures."""

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

"""The sandbox of a policy's process: what a program in it can reach."""

import platform
import shutil
import socket
import subprocess
import sys

import pytest

from kitchen_prefs.evaluation.isolation.sandbox import has_sandbox, start_confined

needs_sandbox = pytest.mark.skipif(not has_sandbox(), reason="needs bubblewrap")


@pytest.fixture
def confined(tmp_path):
    """Runs a command in the sandbox and gives what it printed."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()

    def run(*command, **options):
        process = start_confined(
            command,
            scratch,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            **options,
        )
        return process.communicate()[0]

    return run


@needs_sandbox
def test_what_one_process_writes_no_other_process_sees(confined, tmp_path):
    noted = confined("sh", "-c", "echo observed > note; read -r noted < note; echo $noted; pwd")
    assert noted == f"observed\n{tmp_path / 'scratch'}\n"
    assert confined("sh", "-c", "echo *") == "*\n"
    assert not list((tmp_path / "scratch").iterdir())


ATTEMPTS = """
import os, pathlib, socket, subprocess, sys, threading
folder, secret = sys.argv[1:]
thread = threading.Thread(target=print, args=["a thread runs"])
thread.start(), thread.join()
for attempt in (
    os.fork,
    lambda: subprocess.run(["true"]),
    lambda: os.posix_spawn("/bin/true", ["true"], {}),
    lambda: os.unshare(os.CLONE_NEWUSER),
    lambda: socket.socket(socket.AF_UNIX).connect(folder + "/service"),
    lambda: socket.create_connection(("127.0.0.1", 9)),
    lambda: pathlib.Path(secret).read_text(),
    lambda: pathlib.Path(folder, "link").read_text(),
    lambda: pathlib.Path(folder, "hidden", "salt").read_text(),
    lambda: pathlib.Path(folder, "written").write_text(""),
    lambda: pathlib.Path(folder, "a mount", "written").write_text(""),
    lambda: pathlib.Path("/written").write_text(""),
    lambda: pathlib.Path("/dev/shm/written").write_text(""),
):
    try:
        print("BREACH", attempt())
    except OSError as error:
        print(type(error).__name__, error.strerror)
"""


@needs_sandbox
def test_a_process_starts_no_other_opens_no_socket_and_sees_nothing_else(confined, tmp_path):
    seen, secret = tmp_path / "seen", tmp_path / "secret"
    (seen / "hidden").mkdir(parents=True)
    (seen / "link").symlink_to(secret)
    (seen / "a mount").mkdir()
    for file in (secret, seen / "hidden/salt"):
        file.write_text("12345")
    with socket.socket(socket.AF_UNIX) as service:
        service.bind(str(seen / "service"))
        service.listen()
        said = confined(
            *(sys.executable, "-W", "ignore", "-c", ATTEMPTS, seen, secret),
            readable=[seen],
            hidden=[seen / "hidden"],
        )
    assert said.splitlines() == [
        "a thread runs",
        *["PermissionError Operation not permitted"] * 6,
        *["FileNotFoundError No such file or directory"] * 3,
        *["OSError Read-only file system"] * 4,
    ]


@needs_sandbox
@pytest.mark.parametrize("name", ["a mount", "a\\backslash", "a\ttab"])
def test_a_mount_of_any_name_is_read_only(tmp_path, name):
    (tmp_path / name).mkdir()
    program = f"""
from pathlib import Path
from kitchen_prefs.evaluation.isolation.sandbox import start_confined
folder = Path({str(tmp_path)!r})
command = ["sh", "-c", 'echo x > "$0"/there; echo x > "$0"/written', str(folder / {name!r})]
start_confined(command, folder / "scratch", readable=[folder], confine=True).wait()
"""
    (tmp_path / "scratch").mkdir()
    mounted = 'mount -t tmpfs none "$1" && exec "$2" -c "$3"'
    done = subprocess.run(
        [
            *("unshare", "--user", "--map-root-user", "--mount"),
            *("sh", "-c", mounted, "sh", tmp_path / name, sys.executable, program),
        ],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr.count("Read-only file system") == 2


def test_a_platform_without_bubblewrap_is_no_sandbox(monkeypatch):
    monkeypatch.setattr(shutil, "which", lambda _: None)
    assert not has_sandbox.__wrapped__()


@needs_sandbox
def test_a_processor_without_a_filter_is_no_sandbox(monkeypatch):
    monkeypatch.setattr(platform, "machine", lambda: "riscv64")
    assert not has_sandbox.__wrapped__()

import json
import os
import subprocess
import sys
import textwrap

import pytest
import typer
from typer.testing import CliRunner

from kitchen_prefs import cli
from kitchen_prefs.cli import command_line
from kitchen_prefs.datasets import dataset_names

SMALL = "dishwasher-train-p1-d1-v1"


def run(*arguments):
    return CliRunner().invoke(command_line(), arguments)


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    return tmp_path


def run_program(*arguments, **environment):
    return subprocess.run(
        [sys.executable, "-m", "kitchen_prefs.cli", *arguments],
        check=False,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
    )


def test_control_c_is_said(monkeypatch, capsys):
    app = typer.Typer()

    @app.command()
    def interrupted():
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "command_line", lambda: app)
    monkeypatch.setattr(sys, "argv", ["kitchen-prefs"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == cli.STOPPED
    assert "kitchen-prefs: stopped" in capsys.readouterr().err


def test_list_names_every_data_set(home):
    output = run("datasets", "list").output
    assert [line.split()[0] for line in output.splitlines()] == list(dataset_names())


def test_made_data_sets_are_marked_shown_and_verified(home):
    before = run("datasets", "show", SMALL)
    assert f"kitchen-prefs datasets make {SMALL}" in before.output
    made = run("datasets", "make", SMALL, f"kitchen_prefs/{SMALL}")
    assert made.exit_code == 0
    assert made.stdout.count(f"{SMALL} is in {home}") == 2
    shown = run("datasets", "show", SMALL)
    assert "observation.instances" in shown.output
    assert (home / "kitchen_prefs" / SMALL / "README.md").read_text().count("dishwasher-train") > 1
    verified = run("datasets", "verify", SMALL)
    assert verified.exit_code == 0
    assert "PE 1 and ED 1" in verified.output


def test_what_goes_wrong_is_said_in_one_sentence(home):
    done = run_program("datasets", "show", "dishwasher-tain-v1")
    assert done.returncode == 1
    assert done.stdout == ""
    assert done.stderr.startswith("kitchen-prefs: There is no data set 'dishwasher-tain-v1'.")
    assert "Did you mean 'dishwasher-train-v1'?" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_on_demand_the_traceback_is_shown(home):
    done = run_program("datasets", "show", "dishwasher-tain-v1", KITCHEN_PREFS_DEBUG="1")
    assert done.returncode == 1
    assert "Traceback" in done.stderr
    assert "There is no data set 'dishwasher-tain-v1'." in done.stderr
    assert "KITCHEN_PREFS_DEBUG=1" in run("--help").output


def test_one_unknown_name_keeps_the_others_from_being_made(home):
    assert run("datasets", "make", SMALL, "dishwasher-nonsense-v1").exit_code == 1
    assert list(home.iterdir()) == []


def test_a_home_that_cannot_be_written_ends_in_one_sentence(tmp_path):
    (tmp_path / "file").touch()
    done = run_program("datasets", "make", SMALL, HF_LEROBOT_HOME=str(tmp_path / "file"))
    assert done.returncode == 1
    assert "let the environment variable HF_LEROBOT_HOME name another folder" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(("name", "episodes"), [(SMALL, 1), ("dishwasher-people_train-u1-v2", 2)])
def test_record_keeps_fingerprints_and_cards(tmp_path, monkeypatch, name, episodes):
    recording = "kitchen_prefs.datasets.publishing"
    monkeypatch.setattr(f"{recording}.dataset_names", lambda: (name,))
    monkeypatch.setattr(f"{recording}.FINGERPRINTS", tmp_path / "fingerprints.json")
    assert run("datasets", "record", str(tmp_path / "cards")).exit_code == 0
    known = json.loads((tmp_path / "fingerprints.json").read_text())
    card = (tmp_path / "cards" / f"{name}.md").read_text()
    assert f"`{known['fingerprints'][name]}`" in card
    assert f"| episodes | {episodes} |" in card


@pytest.mark.parametrize("command", ["list", "show", "make", "verify", "push", "record"])
def test_each_command_has_an_example(command):
    help_text = run("datasets", command, "--help").output
    assert f"Example: kitchen-prefs datasets {command}" in help_text


def test_other_packages_add_commands_through_entry_points(tmp_path):
    (tmp_path / "other.py").write_text(
        textwrap.dedent(
            """
            import typer

            app = typer.Typer(name="other")
            alone = typer.Typer()

            @app.callback()
            def group(): ...

            @app.command()
            def hello():
                print("hello from the group")

            @alone.command()
            def fail():
                raise OSError("The disk is made of cheese.")
            """
        )
    )
    metadata = tmp_path / "other-1.0.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: other\nVersion: 1.0\n")
    (metadata / "entry_points.txt").write_text(
        "[kitchen_prefs.commands]\nother = other:app\nalone = other:alone\n"
    )
    assert run_program("other", "hello", PYTHONPATH=str(tmp_path)).stdout == (
        "hello from the group\n"
    )
    done = run_program("fail", PYTHONPATH=str(tmp_path))
    assert done.returncode == 1
    assert done.stderr == "kitchen-prefs: The disk is made of cheese.\n"

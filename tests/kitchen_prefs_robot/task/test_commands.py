"""`kitchen-prefs robot task`, as far as it goes without a policy."""

import pytest
from typer.testing import CliRunner

from kitchen_prefs.cli import command_line


def run(*arguments):
    return CliRunner().invoke(command_line(), ["robot", *arguments])


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--policy.path=x", "--split=tests"], "There is no split 'tests' of the drawers."),
        (["--policy.path=x", "--salt=3"], "There is no option '--salt=3'"),
        (["--policy.path=no/such/folder"], "no/such/folder"),
    ],
)
def test_bad_input_is_one_sentence(arguments, sentence):
    error = run("task", "--sessions=1", *arguments).exception
    assert isinstance(error, (ValueError, OSError))
    assert sentence in str(error)


@pytest.mark.parametrize("command", ["task", "data"])
def test_help_has_an_example(command):
    assert "Example: kitchen-prefs robot" in run(command, "--help").output

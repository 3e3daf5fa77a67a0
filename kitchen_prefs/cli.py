"""The command `kitchen-prefs`.

Other packages add commands through the entry-point group `kitchen_prefs.commands`: each entry names
a typer app. The commands of an app that has a name stand under that name, those of one without
stand at the top.
"""

import os
import sys
from importlib.metadata import entry_points

import typer

from kitchen_prefs.datasets import commands as datasets
from kitchen_prefs.evaluation import commands as evaluation
from kitchen_prefs.physics import commands as physics

STOPPED = 130  # typer's exit code for Ctrl-C, of which it says nothing


def main() -> None:
    """Run a command; an error that the user can correct is one sentence, with exit code 1.

    A bug may raise a ValueError, too; KITCHEN_PREFS_DEBUG=1 shows its traceback.
    """
    try:
        command_line()()
    except (ValueError, OSError) as error:
        if os.environ.get("KITCHEN_PREFS_DEBUG") == "1":
            raise
        sys.exit(f"kitchen-prefs: {_printable(str(error))}")
    except SystemExit as end:
        if end.code == STOPPED:
            print("\nkitchen-prefs: stopped; what was finished stays.", file=sys.stderr)
        raise


def _printable(text: str) -> str:
    """Text without control characters: the name of a submitted file may hold some."""
    return "".join(c if c.isprintable() or c == "\n" else "?" for c in text)


def command_line() -> typer.Typer:
    """The command with the subcommands of all installed packages."""
    app = typer.Typer(
        help="Can a policy learn how THIS user loads a dishwasher, from one demonstration?",
        epilog="With KITCHEN_PREFS_DEBUG=1 in the environment, errors come with their traceback.",
        no_args_is_help=True,
        add_completion=False,
        pretty_exceptions_enable=False,  # main prints one sentence
    )
    found = sorted(entry_points(group="kitchen_prefs.commands"), key=lambda entry: entry.name)
    own = (datasets, evaluation, physics)
    for commands in (*(module.app for module in own), *(entry.load() for entry in found)):
        app.add_typer(commands)
    return app


if __name__ == "__main__":
    main()

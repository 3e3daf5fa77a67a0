"""`kitchen-prefs people`: the tables and the figure of the second tier."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from kitchen_prefs.metrics.references import PEOPLE_REFERENCES
from kitchen_prefs.people.drawings import DRAWINGS
from kitchen_prefs.utils.files import atomic_file, make_folder, write_json

app = typer.Typer(name="people", help="The second tier: people.", no_args_is_help=True)


@app.callback()
def people() -> None:
    """The second tier: people with rules on material, colour, soil and size."""


@app.command()
def certify() -> None:
    """Search the published sessions anew, and record which drawings they are.

    Example: kitchen-prefs people certify
    """
    from kitchen_prefs_experiments.people.certification import search_published

    with atomic_file(DRAWINGS) as unfinished:
        unfinished.write_text(json.dumps(search_published()) + "\n")


@app.command("ladder")
def show_ladder(
    out: Annotated[Path, typer.Option(help="The folder of ladder.md and ladder.json.")],
    sessions: Annotated[
        int | None, typer.Option(help="The first so many of each split.", min=2)
    ] = None,
    salt: Annotated[int, typer.Option(help="The session seed.", min=0)] = 0,
    record: Annotated[
        bool, typer.Option("--record", help="Keep floors and ceilings for the rescaled H.")
    ] = False,
) -> None:
    """What simple readers of a user's demonstrations reach on each split, from floor to ceiling.

    Example: kitchen-prefs people ladder --sessions=25 --out=outputs/ladder
    """
    from kitchen_prefs_experiments.people.ladder import climb, ladder_page, references_of

    if record and (sessions or salt):
        raise ValueError("--record is of all published sessions; leave out --sessions and --salt.")
    make_folder(out, "--out")
    ladder = climb(sessions, salt)
    chosen = f"the first {sessions} sessions" if sessions else "all sessions"
    page = ladder_page(ladder, f"{chosen} with session seed {salt}")
    facts = {
        split: {
            name: {metric: asdict(value.rounded()) for metric, value in metrics.items()}
            for name, metrics in of_split.items()
        }
        for split, of_split in ladder.items()
    }
    write_json(out / "ladder.json", facts)
    with atomic_file(out / "ladder.md") as unfinished:
        unfinished.write_text(page)
    if record:
        write_json(PEOPLE_REFERENCES, references_of(ladder))
    typer.echo(page)


@app.command("figure")
def draw_figure(
    out: Annotated[Path, typer.Option(help="The picture, a PNG file.")],
) -> None:
    """Four users' racks and sinks after each has loaded the same dishes, under their rules.

    Example: kitchen-prefs people figure --out=docs/people.png
    """
    from kitchen_prefs_experiments.people.figure import draw_users

    if out.suffix != ".png":
        raise ValueError(f"The picture is a PNG file, but --out is {out}; give a name with .png.")
    make_folder(out.parent, "--out")
    figure = draw_users()
    with atomic_file(out) as unfinished:
        figure.save(unfinished, optimize=True)
    typer.echo(f"{out}: four users, the same dishes.")

"""`kitchen-prefs reproduce`, `kitchen-prefs results` and `kitchen-prefs readme-table`.

LeRobot and altair take seconds to import, so the commands import what needs them when they run.
"""

import json
from pathlib import Path
from typing import Annotated

import typer

from kitchen_prefs.utils.files import atomic_file, make_folder
from kitchen_prefs_experiments.paper.paper_tables import TABLES, get_table
from kitchen_prefs_experiments.paper.table_types import Curves

app = typer.Typer()

Results = Annotated[Path, typer.Option(help="The folder of the tables' JSON and pictures.")]


@app.command()
def reproduce(
    tables: Annotated[list[str], typer.Argument(metavar="TABLE", help=f"Of {', '.join(TABLES)}.")],
    budget: Annotated[
        int, typer.Option(help="The number of decisions in each training of a table.", min=1)
    ] = 32_000,  # 1,000 steps of 32: some 15 minutes on two cores
    jobs: Annotated[
        int, typer.Option(help="The number of policies trained at once, one per core.", min=1)
    ] = 2,
    out: Annotated[Path, typer.Option(help="The folder of the runs and episodes.")] = Path(
        "outputs/reproduce"
    ),
    results: Results = Path("docs/results"),
) -> None:
    """Re-run tables of the paper: train what they need, evaluate it, write JSON and a picture.

    Finished runs and episodes are kept: a command that was stopped resumes.
    The table "learning" runs the recipes unchanged, in outputs/;
    --budget, --jobs and --out do not apply to it.

    For example:
    kitchen-prefs reproduce main counts
    kitchen-prefs reproduce attributes --budget=32000
    """
    chosen = {name: get_table(name) for name in tables}
    make_folder(out, "--out")
    make_folder(results, "--results")
    typer.echo(f"Runs and episodes go to {out}, tables and pictures to {results}.")
    from kitchen_prefs_experiments.paper.figures import draw
    from kitchen_prefs_experiments.paper.learning_curves import run_curves
    from kitchen_prefs_experiments.paper.result_files import write_results
    from kitchen_prefs_experiments.paper.table_runner import run_table

    for name, table in chosen.items():
        found = (
            run_curves(name, table)
            if isinstance(table, Curves)
            else run_table(name, table, budget, jobs, out)
        )
        write_results(found, results)
        draw(table, found, results / f"{name}.png")
        typer.echo(f"{name} is in {results}.")


@app.command("results")
def write_pages(results: Results = Path("docs/results")) -> None:
    """Write the pages and pictures of the results, from the files in the folder alone.

    For example:
    kitchen-prefs results
    """
    from kitchen_prefs_experiments.paper.figures import draw
    from kitchen_prefs_experiments.paper.result_files import read_results
    from kitchen_prefs_experiments.paper.results_page import pages

    if not read_results(results):
        raise ValueError(
            f"{results} holds no results; `kitchen-prefs reproduce TABLE` writes some there, or "
            "give another --results."
        )
    for name, text in pages(results).items():
        with atomic_file(results / f"{name}.md") as unfinished:
            unfinished.write_text(text)
    for name, found in read_results(results).items():
        draw(TABLES[name], found, results / f"{name}.png")
    typer.echo(f"The pages are in {results}; index.md is the overview.")


@app.command()
def readme_table(
    scores: Annotated[
        Path, typer.Option(help="The JSON of `kitchen-prefs leaderboard score`.")
    ] = Path("leaderboard/scores.json"),
    readme: Annotated[Path, typer.Option(help="The file with the table.")] = Path("README.md"),
) -> None:
    """Write the README's table of results from the leaderboard's scores.

    For example:
    kitchen-prefs readme-table
    """
    from kitchen_prefs_experiments.paper.readme_table import replace_table

    text = replace_table(readme.read_text(), json.loads(scores.read_text()))
    with atomic_file(readme) as unfinished:
        unfinished.write_text(text)
    typer.echo(f"The table is in {readme}.")

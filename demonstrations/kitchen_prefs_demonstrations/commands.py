"""`kitchen-prefs demonstrate`: the page; `kitchen-prefs demonstrations`: import, agreement.

LeRobot takes seconds to import, so the commands import what needs it when they run.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from kitchen_prefs.utils.files import at_work_alone, atomic_file, make_folder
from kitchen_prefs_demonstrations.file_format import check_study_name

if TYPE_CHECKING:
    from kitchen_prefs_demonstrations.importing import ImportedEpisode
    from kitchen_prefs_demonstrations.replaying import ReplayedDemonstration

demonstrate = typer.Typer(name="demonstrate")
demonstrations = typer.Typer(
    name="demonstrations",
    help="Demonstrations of people: data sets, and how far people agree.",
    no_args_is_help=True,
)
app = typer.Typer()
app.add_typer(demonstrate)
app.add_typer(demonstrations)
console = Console()

Files = Annotated[list[Path], typer.Argument(metavar="FILE", help="What the page gave.")]
StudyName = Annotated[
    str | None, typer.Option("--study", help="A study's name.", show_default="no study")
]


@demonstrate.callback(invoke_without_command=True)
def serve(
    context: typer.Context,
    out: Annotated[Path, typer.Option(help="Where demonstrations are saved.")] = Path(
        "outputs/demonstrations"
    ),
    port: Annotated[int, typer.Option(help="The port on this machine.", min=0, max=65535)] = 8765,
    study: StudyName = None,
) -> None:
    """Serve the page on this machine and save each demonstration; Ctrl-C ends it.

    In a study the page asks for a participant's code and day instead of a name.

    For example:
    kitchen-prefs demonstrate --out=study --study=kitchen-2027
    """
    if context.invoked_subcommand:
        if study is not None:
            raise ValueError("--study belongs after `demonstrate page`, not before `page`.")
        return
    from kitchen_prefs_demonstrations.serving import SAVE_TO, DemonstrationServer

    html = _page(study, SAVE_TO)
    make_folder(out, "--out")
    serving = DemonstrationServer(html, out, port, _print_saved, study)
    with serving as server, at_work_alone(out):
        console.print(f"The page is at {server.address}; demonstrations go to {out}.")
        try:
            server.serve_forever()
        except KeyboardInterrupt:
            console.print("Stopped; what was saved stays.")


@demonstrate.command("page")
def write_page(
    out: Annotated[Path, typer.Option(help="The HTML file.")],
    study: StudyName = None,
) -> None:
    """Write the page as one HTML file that needs no server; a visitor downloads demonstrations.

    For example:
    kitchen-prefs demonstrate page --out=outputs/demonstrate.html
    """
    if out.is_dir():
        raise ValueError(f"{out} is a folder; give --out a file in it.")
    html = _page(study, None)
    make_folder(out.parent, "--out")
    with atomic_file(out) as unfinished:
        unfinished.write_text(html)
    console.print(f"The page is {out}; a browser opens it without a server.")


@demonstrations.command("import")
def import_files(
    files: Files,
    name: Annotated[str, typer.Option(help="The data set's name, such as my_kitchen.")],
    without_consent: Annotated[
        bool, typer.Option("--without-consent", help="Take files without consent, too.")
    ] = False,
) -> None:
    """Write demonstrations as the data set kitchen_prefs/NAME, one episode a file.

    A file without consent is refused, unless --without-consent says that it is your own or that the
    data set stays with you.

    For example:
    kitchen-prefs demonstrations import outputs/demonstrations/*.json --name=my_kitchen
    """
    from kitchen_prefs_demonstrations.importing import import_demonstrations

    episodes = import_demonstrations(files, name, without_consent)
    table = Table("Episode", "User", "Finished", "Preference", "Explains", "Pairs", title=name)
    for number, episode in enumerate(episodes):
        table.add_row(str(number), *_row(episode))
    console.print(table)
    console.print("Explains: share of picks and places. Pairs: how many of 9 are shown in order.")
    console.print(f"The data set is kitchen_prefs/{name}; --prompt={name}:0 prompts a policy.")


@demonstrations.command("agreement")
def show_agreement(files: Files) -> None:
    """Show how far users agree with themselves and with others on the same kitchen.

    For example:
    kitchen-prefs demonstrations agreement study/*.json
    """
    from kitchen_prefs_demonstrations.agreement import agreement
    from kitchen_prefs_demonstrations.comparison import MEASURES
    from kitchen_prefs_demonstrations.replaying import read_and_replay

    found = agreement([read_and_replay(file) for file in files])
    table = Table("", "Pairs", *MEASURES, title=f"{found.users} users")
    for name, words in (("self", "with herself"), ("others", "with others")):
        intervals = [found.measures[name].get(measure) for measure in MEASURES]
        figures = [str(interval or "-") for interval in intervals]
        table.add_row(words, str(found.pairs[name]), *figures)
    console.print(table)


def _page(study: str | None, save_to: str | None) -> str:
    from kitchen_prefs_demonstrations.page.building import demonstration_page

    if study is not None:
        check_study_name(study)
    with console.status("Making the page, which takes half a minute..."):
        return demonstration_page(study=study, save_to=save_to)


def _print_saved(file: Path, demonstration: "ReplayedDemonstration") -> None:
    racked = int((demonstration.kitchen.placement >= 0).sum())
    end = "finished" if demonstration.finished else "not finished"
    who = demonstration.file.who or "a visitor"
    console.print(f"{file}: {who}, {len(demonstration.decisions)} decisions, ", end="")
    console.print(f"{racked} dishes in the racks, {end}")


def _row(episode: "ImportedEpisode") -> tuple[str, ...]:
    file, implied = episode.replayed.file, episode.implied
    words = implied.preference.in_words if implied.is_followed else f"none: {implied.why_not}"
    finished = "yes" if episode.replayed.finished else "no"
    return file.who or "-", finished, words, f"{implied.share:.0%}", str(implied.ordered)

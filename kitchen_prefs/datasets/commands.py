"""`kitchen-prefs datasets`: list, show, make, verify, draw, push; for developers, record, cards."""

from pathlib import Path
from typing import Annotated

import typer

from kitchen_prefs.datasets.columns import features_of
from kitchen_prefs.datasets.loading import make_dataset
from kitchen_prefs.datasets.manifest import published_fingerprint, read_manifest
from kitchen_prefs.datasets.names import content_of, dataset_names, dataset_root

app = typer.Typer(name="datasets", help="Demonstrations by name.", no_args_is_help=True)

Name = Annotated[str, typer.Argument(help="The data set's name, such as dishwasher-train-v1.")]
Names = Annotated[list[str], typer.Argument(help="The data sets' names.")]


@app.command("list")
def list_names() -> None:
    """List the published data sets; those marked * are on this machine.

    Example: kitchen-prefs datasets list
    """
    for name in dataset_names():
        content = content_of(name)
        mark = "*" if dataset_root(name).exists() else " "
        typer.echo(f"{mark} {name:34} {len(content.sessions):5} episodes  {content.purpose}")


@app.command()
def show(name: Name) -> None:
    """Show what a data set holds and where it lies.

    Example: kitchen-prefs datasets show dishwasher-train-v1
    """
    content = content_of(name)
    root = dataset_root(content.name)
    typer.echo(f"{content.repo_id}: {len(content.sessions)} episodes, for {content.purpose}")
    for column, feature in features_of(content.name).items():
        typer.echo(f"  {column:30} {feature['dtype']:8} {feature['shape']}")
    published = published_fingerprint(content.name) or "none recorded"
    typer.echo(f"published fingerprint  {published}")
    if not root.exists():
        typer.echo(f"not on this machine; `kitchen-prefs datasets make {content.name}` makes it")
        return
    manifest = read_manifest(content.name, root)
    typer.echo(f"fingerprint            {manifest['fingerprint']}")
    typer.echo(f"frames                 {manifest['frames']}")
    typer.echo(f"folder                 {root}")
    typer.echo(f"card                   {root / 'README.md'}")


@app.command()
def make(names: Names) -> None:
    """Make data sets that are not there yet, on all cores.

    Example: kitchen-prefs datasets make dishwasher-train-v1 dishwasher-val-v1
    """
    for name in [content_of(name).name for name in names]:
        typer.echo(f"{name} is in {make_dataset(name)}")


@app.command()
def verify(names: Names) -> None:
    """Check data sets: fingerprint, statistics, indices, labels, actions, and a replay.

    Example: kitchen-prefs datasets verify dishwasher-train-v1
    """
    from kitchen_prefs.datasets.verification import verify_dataset

    for name in names:
        typer.echo(name)
        for claim in verify_dataset(name):
            typer.echo(f"  {claim}")


@app.command()
def draw(
    name: Name,
    episodes: Annotated[
        str | None,
        typer.Option(help="Which episodes, such as 0,3,7.", show_default="all"),
    ] = None,
) -> None:
    """Copy a data set with a drawing of each decision, to look at with lerobot-dataset-viz.

    The copy is kitchen_prefs/NAME-drawn.

    Example: kitchen-prefs datasets draw dishwasher-val-v1 --episodes=0,3,7
    """
    numbers = None if episodes is None else _numbers(episodes)
    from kitchen_prefs.datasets.drawing import draw_dataset  # imports LeRobot: seconds

    folder = draw_dataset(name, numbers)
    typer.echo(f"{folder.parent.name}/{folder.name} is in {folder}")


@app.command()
def push(
    name: Name,
    repo_id: Annotated[str, typer.Option(help="Its name on the Hugging Face hub, OWNER/NAME.")],
    private: Annotated[
        bool, typer.Option("--private", help="Make a new repository a private one.")
    ] = False,
) -> None:
    """Check a data set as `verify` does, and put it on the Hugging Face hub with its card.

    The hub knows you by `hf auth login`, or by a token in HF_TOKEN.

    Example: kitchen-prefs datasets push dishwasher-val-v1 --repo-id=OWNER/dishwasher-val-v1
    """
    from kitchen_prefs.datasets.hub_upload import push_dataset

    typer.echo(f"{content_of(name).name} is at {push_dataset(name, repo_id, private)}")


@app.command()
def record(
    cards: Annotated[Path, typer.Argument(help="The folder of the cards.")] = Path("dataset_cards"),
) -> None:
    """Make all published data sets anew and record their fingerprints and cards (for developers).

    Example: kitchen-prefs datasets record
    """
    from kitchen_prefs.datasets.publishing import record_published  # imports LeRobot: seconds

    record_published(cards)


@app.command("cards")
def write_cards(
    cards: Annotated[Path, typer.Argument(help="The folder of the cards.")] = Path("dataset_cards"),
) -> None:
    """Write the cards of all published data sets from their recorded facts (for developers).

    Example: kitchen-prefs datasets cards
    """
    from kitchen_prefs.datasets import publishing  # imports LeRobot: seconds

    publishing.write_cards(cards)


def _numbers(text: str) -> list[int]:
    try:
        return [int(number) for number in text.split(",")]
    except ValueError as error:
        raise ValueError(f"--episodes is a list of numbers such as 0,3,7, not {text!r}.") from error

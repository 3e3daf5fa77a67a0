"""`kitchen-prefs robot demonstrate` and `verify`: a person shows how the drawers are loaded.

MuJoCo and LeRobot are imported inside the command, so that `kitchen-prefs --help` does not wait.
"""

import os
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from tqdm import tqdm

from kitchen_prefs.datasets.names import dataset_root

if TYPE_CHECKING:
    from kitchen_prefs_robot.demonstrations.recording import HumanDemonstration


# Of the published data set; no experiment uses these scenes.
SCENES, PREFERENCES = range(900, 905), range(4)


def demonstrate(
    out: Annotated[
        Path | None, typer.Option(help="Folder of the data set; by default LeRobot's for it.")
    ] = None,
    scene: Annotated[
        list[int], typer.Option(min=0, help="Seed of the scene; may be repeated.")
    ] = list(SCENES),  # noqa: B006 (typer copies it)
    preference: Annotated[
        list[int], typer.Option(help="Number of the preference, 0 to 3; may be repeated.")
    ] = list(PREFERENCES),  # noqa: B006
    colours: Annotated[
        Literal["distinct", "alike"], typer.Option(help="Of the dishes.")
    ] = "distinct",
    lamp: Annotated[
        float, typer.Option(min=0, max=0.5, help="How much the light changes at most, a share.")
    ] = 0.0,
    depth_noise: Annotated[float, typer.Option(min=0, help="Times the camera's own noise.")] = 1.0,
) -> None:
    """Record human demonstrations as a LeRobot data set, one for each scene and preference.

    Without options it makes the published one: four preferences, five scenes each.

    Example: kitchen-prefs robot demonstrate --scene=3 --preference=0 --out=demonstration
    """
    os.environ.setdefault("SVT_LOG", "1")  # the video encoder's errors alone
    from kitchen_prefs_robot.demonstrations.preferences import human_preference
    from kitchen_prefs_robot.demonstrations.recording import record
    from kitchen_prefs_robot.demonstrations.storage import NAME, write_demonstrations

    for number in preference:
        human_preference(number)
    misread: list[int] = []

    def recorded() -> "Iterator[HumanDemonstration]":
        pairs = list(product(scene, preference))
        for seed, number in tqdm(pairs, "Demonstrating", unit="episode"):
            shown = record(seed, number, colours, lamp, depth_noise)
            misread.append(len({own for own, _ in shown.misread}))
            yield shown

    root = out or dataset_root(NAME)
    write_demonstrations(recorded(), root)
    typer.echo(
        f"{len(misread)} demonstrations are in {root}; {sum(misread)} dishes were taken for "
        "another category."
    )


def verify(
    root: Annotated[
        Path | None, typer.Option(help="Folder of the data set; by default LeRobot's for it.")
    ] = None,
) -> None:
    """Check the human demonstrations: chosen rows, actions, and the published fingerprint.

    Example: kitchen-prefs robot verify --root=drawers-human-v1
    """
    from kitchen_prefs_robot.demonstrations.storage import NAME
    from kitchen_prefs_robot.demonstrations.verification import verify_demonstrations

    for claim in verify_demonstrations(NAME, root or dataset_root(NAME)):
        typer.echo(claim)

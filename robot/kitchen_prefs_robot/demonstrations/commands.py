"""`kitchen-prefs robot demonstrate`: a person shows how the drawers are loaded.

MuJoCo and LeRobot are imported inside the command, so that `kitchen-prefs --help` does not wait.
"""

import os
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer
from tqdm import tqdm

if TYPE_CHECKING:
    from kitchen_prefs_robot.demonstrations.recording import HumanDemonstration


def demonstrate(
    out: Annotated[Path, typer.Option(help="Folder of the data set that is made.")],
    scene: Annotated[list[int], typer.Option(min=0, help="Seed of the scene; may be repeated.")],
    preference: Annotated[
        list[int], typer.Option(help="Number of the preference, 0 to 3; may be repeated.")
    ],
    colours: Annotated[
        Literal["distinct", "alike"], typer.Option(help="Of the dishes.")
    ] = "distinct",
    lamp: Annotated[
        float, typer.Option(min=0, max=0.5, help="How much the light changes at most, a share.")
    ] = 0.0,
    depth_noise: Annotated[float, typer.Option(min=0, help="Times the camera's own noise.")] = 1.0,
) -> None:
    """Record human demonstrations as a LeRobot data set, one for each scene and preference.

    Example: kitchen-prefs robot demonstrate --scene=3 --preference=0 --out=demonstration
    """
    os.environ.setdefault("SVT_LOG", "1")  # the video encoder's errors alone
    from kitchen_prefs_robot.demonstrations.recording import record
    from kitchen_prefs_robot.demonstrations.storage import write_demonstrations

    misread: list[int] = []

    def recorded() -> "Iterator[HumanDemonstration]":
        pairs = list(product(scene, preference))
        for seed, number in tqdm(pairs, "Demonstrating", unit="episode"):
            shown = record(seed, number, colours, lamp, depth_noise)
            misread.append(shown.misread)
            yield shown

    write_demonstrations(recorded(), out)
    typer.echo(
        f"{len(misread)} demonstrations are in {out}; {sum(misread)} dishes in hand were taken for "
        "another category."
    )

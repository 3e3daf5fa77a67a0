"""`kitchen-prefs physics`: make the placements and check them; both write into simulation/.

MuJoCo is imported inside the commands, so that `kitchen-prefs --help` does not wait for it.
"""

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import repeat
from multiprocessing import get_context
from typing import Annotated

import numpy as np
import typer
from tqdm import tqdm

from kitchen_prefs.people.sessions import make_people_session
from kitchen_prefs.people.splits import get_people_split
from kitchen_prefs.preferences import CATEGORIES, RACKS
from kitchen_prefs.simulation.kitchen import IN_RACK
from kitchen_prefs.simulation.placements import LARGEST, load_placements, load_record
from kitchen_prefs.simulation.sessions import expert_trajectory, make_session
from kitchen_prefs.splits import get_split
from kitchen_prefs.utils.extras import require_mujoco

app = typer.Typer(
    name="physics", help="Make and check where dishes can stand in a rack.", no_args_is_help=True
)

ENOUGH = 0.95  # of the carried dishes must stay
CHECKED_SPLIT = {1.0: "train", LARGEST: "people_train"}

Largest = Annotated[
    bool, typer.Option("--largest", help="Those of the second tier, for its largest dishes.")
]


@app.command("make-placements")
def make(
    seed: Annotated[int, typer.Option(help="Of the random drops.")] = 0, largest: Largest = False
) -> None:
    """Drop, settle and choose placements anew, and test which block each other.

    Example: kitchen-prefs physics make-placements --seed 0
    """
    require_mujoco()
    from kitchen_prefs.physics.placement_search import (
        count,
        describe,
        make_placements,
        save_placements,
    )

    scale = LARGEST if largest else 1.0
    placements = make_placements(seed, scale)
    save_placements(placements, describe(placements, seed, scale), scale)
    typer.echo(f"{len(placements.category)} placements made: {count(placements)}.")


@app.command("check-placements")
def check(
    sessions: Annotated[int, typer.Option(help="How many expert sessions.")] = 50,
    largest: Largest = False,
) -> None:
    """Carry the expert's loads under contact physics, and reject placements that do not hold.

    Each rack that the expert has loaded settles and slides in over 4 s. The share of dishes that
    stay is recorded. Where placements are at fault they are dropped instead: check again.

    Example: kitchen-prefs physics check-placements --sessions 50
    """
    require_mujoco()
    from kitchen_prefs.physics.carrying import STAY
    from kitchen_prefs.physics.placement_search import count, save_placements, without

    scale = LARGEST if largest else 1.0
    loads = list(_expert_loads(sessions, scale))
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        carried = pool.map(_carry_load, loads, repeat(scale))
        stayed = list(tqdm(carried, "Sliding racks in", len(loads)))
    placement, stays = np.concatenate(loads), np.concatenate(stayed)
    share = float(stays.mean())
    typer.echo(f"{share:.1%} of {len(stays)} dishes stayed within 3 cm and 20 degrees.")
    placements, record = load_placements(scale), load_record(scale)
    rejected = _at_fault(placement, stays)
    if len(rejected):
        placements = without(placements, rejected)
        record["counts"] = count(placements)
        record["rejected"] = record.get("rejected", 0) + len(rejected)
        record.pop("truth_check", None)
        save_placements(placements, record, scale)
        typer.echo(f"{len(rejected)} placements were at fault and are gone: check again.")
        raise typer.Exit(1)
    record["truth_check"] = {
        "split": CHECKED_SPLIT[scale],
        "sessions": sessions,
        "dishes": len(stays),
        "stayed": round(share, 4),
        "within": {"metres": STAY[0], "degrees": round(float(np.rad2deg(STAY[1])), 1)},
    }
    save_placements(placements, record, scale)
    if share < ENOUGH:
        typer.echo(f"At least {ENOUGH:.0%} should stay: the rack's tines hold too little.")
        raise typer.Exit(1)


def _expert_loads(sessions: int, scale: float) -> Iterator[np.ndarray]:
    """The placements that the expert takes in each rack, evenly drawn from a split's sessions."""
    split = CHECKED_SPLIT[scale]
    of_people = scale == LARGEST
    size = (get_people_split(split) if of_people else get_split(split)).sessions
    for index in np.linspace(0, size - 1, sessions).astype(int).tolist():
        if of_people:
            kitchen = make_people_session(split, index).expert.trajectory.kitchen
        else:
            kitchen = expert_trajectory(make_session(split, index)).kitchen
        for rack in RACKS:
            yield kitchen.placement[kitchen.location == IN_RACK[rack]]


def _carry_load(load: np.ndarray, scale: float) -> np.ndarray:
    """Whether each dish of a load, given by its placements, stays; (n,) bool."""
    from kitchen_prefs.physics.carrying import carry

    placements = load_placements(scale)
    poses = np.hstack([placements.position[load], placements.quaternion[load]]).astype(float)
    return carry([CATEGORIES[c] for c in placements.category[load]], poses, scale)


def _at_fault(placement: np.ndarray, stays: np.ndarray) -> np.ndarray:
    """The placements whose dish moved more often than it stayed."""
    moved = np.bincount(placement, ~stays)
    return np.flatnonzero(2 * moved > np.bincount(placement))

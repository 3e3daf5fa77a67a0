"""Reads data sets of demonstrations: as prompts, and what each episode shows."""

import json
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from kitchen_prefs import instances
from kitchen_prefs.datasets.columns import SETS, flat_numbers
from kitchen_prefs_robot.task.rows import prompt_of

MADE_OF = Path("meta") / "demonstrations.json"


@dataclass(frozen=True)
class Origin:
    """What an episode of a data set shows.

    Attributes:
        scene: The seed of the scene.
        preference: The number of the preference.
        misread: As `HumanDemonstration.misread`.
    """

    scene: int
    preference: int
    misread: tuple[tuple[str, str], ...]


class NoDataSetError(ValueError):
    """There is no data set in a folder."""

    def __init__(self, root: Path) -> None:
        super().__init__(f"There is no data set of demonstrations in {root}; give its folder.")


@contextmanager
def damage_told(root: Path) -> Iterator[None]:
    """Say of a data set that cannot be read that it is damaged, or another one.

    Raises:
        ValueError: If what is done with it fails.
    """
    try:
        yield
    except NoDataSetError:
        raise
    except (pa.ArrowException, ValueError, KeyError, TypeError, AttributeError, OSError) as error:
        raise ValueError(
            f"{root} is damaged or no data set of these demonstrations; make it again with "
            "`kitchen-prefs robot demonstrate`."
        ) from error


def read_prompt(root: Path, episode: int = 0) -> np.ndarray:
    """An episode of a data set as a prompt.

    Args:
        root: The data set's folder.
        episode: Its number.

    Returns:
        The sets of all its decisions, the chosen rows marked, (1664, 14) float32.

    Raises:
        ValueError: If there is no such data set or episode.
    """
    with damage_told(root):
        table = read_frames(root, (SETS, "chosen_index", "episode_index"))
    numbers = flat_numbers(table["episode_index"])
    chosen = flat_numbers(table["chosen_index"])[numbers == episode]
    if len(chosen) == 0:
        last = numbers.max(initial=-1)
        raise ValueError(f"There is no episode {episode} in {root}; the last is {last}.")
    sets = flat_numbers(table[SETS]).reshape(len(numbers), -1)[numbers == episode]  # (T, 936)
    return prompt_of([instances.unpad(one) for one in sets], chosen.tolist())


def read_origin(root: Path, episode: int = 0) -> Origin:
    """What an episode of a data set shows.

    Args:
        root: The data set's folder.
        episode: Its number.

    Raises:
        ValueError: If there is no such data set or episode.
    """
    file = root / MADE_OF
    if not file.is_file():
        raise NoDataSetError(root)
    with damage_told(root):
        episodes = json.loads(file.read_text())["episodes"]
        origins = [
            Origin(int(one["scene"]), int(one["preference"]), _pairs(one.get("misread", [])))
            for one in episodes
        ]
    if episode >= len(origins):
        raise ValueError(
            f"There is no episode {episode} in {root}; the last is {len(origins) - 1}."
        )
    return origins[episode]


def read_frames(root: Path, columns: Sequence[str]) -> pa.Table:
    """Some columns of a data set, in frame order.

    Raises:
        ValueError: If there is no data set.
    """
    paths = sorted(root.glob("data/*/*.parquet"))
    if not paths:
        raise NoDataSetError(root)
    return pa.concat_tables([pq.read_table(path, columns=list(columns)) for path in paths])


def _pairs(misread: Iterable[Sequence[str]]) -> tuple[tuple[str, str], ...]:
    """Pairs of categories as JSON has them."""
    return tuple((str(own), str(seen)) for own, seen in misread)

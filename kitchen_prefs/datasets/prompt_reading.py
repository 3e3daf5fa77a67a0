"""Reads one episode of a data set as a prompt."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from kitchen_prefs.datasets.columns import SETS, flat_numbers
from kitchen_prefs.datasets.names import NAMESPACE, dataset_root
from kitchen_prefs.envs.demonstrations import marked_prompt
from kitchen_prefs.envs.given_prompt import GivenPrompt
from kitchen_prefs.instances import DESCRIBED_FLAT_SIZE
from kitchen_prefs.simulation.sessions import preference_with

WANTED = (SETS, "chosen_index", "preference", "episode_index")


def read_prompt(name: str) -> GivenPrompt:
    """Read an episode of a data set as a prompt.

    Args:
        name: NAME or NAME:EPISODE; the first episode is 0, and the one without a number.

    Raises:
        ValueError: If there is no such data set or episode, or if the episode follows no known
            preference, so that nobody says what would be right.
    """
    dataset, _, number = name.removeprefix(f"{NAMESPACE}/").partition(":")
    if not (number or "0").isdecimal():
        raise ValueError(f"A prompt is NAME or NAME:EPISODE, such as my_kitchen:0, not {name!r}.")
    episode = int(number or 0)
    columns = _read(dataset_root(dataset))
    mine = columns["episode_index"] == episode  # (T,)
    if not mine.any():
        last = columns["episode_index"].max(initial=-1)
        raise ValueError(f"The data set {dataset} has no episode {episode}; the last is {last}.")
    if columns[SETS].size == len(mine) * DESCRIBED_FLAT_SIZE:
        raise ValueError(
            f"{dataset} is of the second tier, whose users the splits of the first do not have; "
            "give a data set of the first, such as dishwasher-val-v1."
        )
    label = int(columns["preference"][mine][0])
    if label < 0:
        raise ValueError(
            f"Episode {episode} of {dataset} follows no preference of the benchmark, so no expert "
            "says what would be right; `kitchen-prefs demonstrations agreement` compares people."
        )
    sets = columns[SETS].reshape(len(mine), -1)[mine]  # (t, N D)
    return GivenPrompt(marked_prompt(sets, columns["chosen_index"][mine]), preference_with(label))


def _read(root: Path) -> dict[str, np.ndarray]:
    files = sorted(root.glob("data/*/*.parquet"))
    if not files:
        raise ValueError(
            f"There is no data set {root.name} in {root.parent}; `kitchen-prefs demonstrations "
            "import` makes one of demonstrations, `kitchen-prefs datasets make` a published one."
        )
    try:
        table = pa.concat_tables([pq.read_table(path, columns=list(WANTED)) for path in files])
    except (pa.ArrowInvalid, KeyError) as error:
        raise ValueError(f"The data set {root} is damaged, or none of kitchen_prefs.") from error
    return {name: flat_numbers(table[name]) for name in WANTED}

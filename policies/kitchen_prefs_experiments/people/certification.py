"""Searches the published sessions of the certified splits, on all cores."""

from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context

from tqdm import tqdm

from kitchen_prefs.people.drawings import Drawing
from kitchen_prefs.people.sessions import search_drawing
from kitchen_prefs.people.splits import PEOPLE_SPLITS


def search_published() -> dict[str, list[Drawing]]:
    """The drawing of each published session of each certified split."""
    found = {}
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        for split in PEOPLE_SPLITS.values():
            if split.certified:
                search = partial(search_drawing, split, salt=0)
                drawings = pool.map(search, range(split.sessions), chunksize=2)
                found[split.name] = list(tqdm(drawings, split.name, split.sessions, unit="session"))
    return found

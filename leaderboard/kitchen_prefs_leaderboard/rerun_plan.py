"""What a re-run rolls out: published sessions and fresh ones, whose seed nobody knows before."""

import secrets
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kitchen_prefs.evaluation.rollouts import BATCH_SIZE
from kitchen_prefs.evaluation.tiers import tier_of
from kitchen_prefs.simulation.sessions import FRESH_USERS, PUBLISHED_USERS

ALONE = 2  # fresh sessions of each split that are also rolled out in a batch of their own
LABELLED_TRACKS = ("privileged", "open")  # there a preference may have to be one of the twelve
MOST_SALT = 2**53  # the page's JavaScript holds every integer below


@dataclass(frozen=True)
class Run:
    """One roll-out of the test splits of a tier.

    Attributes:
        name: The folder of its episodes.
        salt: The session seed.
        few: Whether it has `ALONE` sessions of each split, which the seed chooses.
        batch_size: How many sessions are rolled out at once.
    """

    name: str
    salt: int
    few: bool = False
    batch_size: int = BATCH_SIZE

    def sessions(self, split: str) -> Sequence[int]:
        """Its sessions of a split."""
        tier = tier_of(split)
        everything = range(tier.sessions(split))
        if not self.few:
            return everything
        generator = np.random.default_rng([self.salt, tier.test_splits.index(split)])
        return sorted(generator.choice(everything, ALONE, replace=False).tolist())


def fresh_run(folder: Path, track: str, salt: int | None) -> Run:
    """The run on sessions that nobody has published; one that was begun in the folder goes on.

    Its users are fresh too, except for the seven whom training shows, and except on tracks that
    show a preference's label.

    Args:
        folder: The folder of the re-run.
        track: The submission's track.
        salt: The session seed; None draws one.
    """
    begun = sorted(folder.glob("fresh-[1-9]*"))
    if salt is None and begun:
        salt = int(begun[0].name.removeprefix("fresh-"))
    if salt is None:
        published = track in LABELLED_TRACKS
        first, end = (PUBLISHED_USERS, MOST_SALT) if published else (FRESH_USERS, PUBLISHED_USERS)
        salt = first + secrets.randbelow(end - first)
    return Run(f"fresh-{salt}", salt)

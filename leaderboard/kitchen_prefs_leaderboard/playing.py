"""A LeRobot policy plays the test splits, a process for each split."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tqdm import tqdm

from kitchen_prefs.actors import Actor, load_actor
from kitchen_prefs.evaluation import settings_of
from kitchen_prefs.metrics import Episode
from kitchen_prefs.records import read_episodes
from kitchen_prefs.reproduction.processes import run_module
from kitchen_prefs.splits import TEST_SPLITS

LONGEST = ("unseen_counts", "many_preferences", "unseen_both")


@dataclass(frozen=True)
class Player:
    """A policy that plays.

    Attributes:
        actor: The policy.
        named: What `kitchen-prefs evaluate` is told of it.
    """

    actor: Actor
    named: tuple[str, ...]

    def play(self, folder: Path, salt: int, jobs: int) -> dict[str, list[Episode]]:
        """Play the test splits; what is played already is not played again.

        Args:
            folder: Keeps the episodes.
            salt: 0 for the published sessions, else fresh ones.
            jobs: How many splits are played at once.

        Returns:
            The episodes of each split, in the order of the sessions.

        Raises:
            OSError: If an evaluation fails; the message names its log.
        """
        folder.mkdir(parents=True, exist_ok=True)
        splits = sorted(TEST_SPLITS, key=lambda split: split not in LONGEST)  # they begin first

        def evaluate(split: str) -> None:
            where = [f"--split={split}", f"--out={folder}", f"--salt={salt}"]
            arguments = ["evaluate", *self.named, *where]
            run_module("kitchen_prefs.cli", arguments, folder / f"{split}.log", split)

        with ThreadPoolExecutor(jobs) as pool:
            list(tqdm(pool.map(evaluate, splits), "Playing", len(splits), unit="split"))
        return {
            split: sorted(read_episodes(folder / f"{split}.jsonl"), key=lambda one: one.session)
            for split in TEST_SPLITS
        }


def load_player(
    path: str | None, policy_type: str | None, settings: Sequence[str], track: str
) -> Player:
    """Load a policy for a track of the leaderboard.

    Args:
        path: A checkpoint, see `load_actor`.
        policy_type: The type of a policy that needs no training.
        settings: Settings of the policy to override, as in `--policy.rule=symbolic`.
        track: What the policy is told; on the open track it is told what it asks for.

    Raises:
        ValueError: If it cannot be loaded, see `load_actor`.
    """
    told = None if track == "open" else track
    actor = load_actor(path, policy_type, settings_of(settings), track=told)
    policy = f"--policy.path={path}" if path else f"--policy.type={policy_type}"
    return Player(actor, (policy, *settings, f"--track={actor.track}"))

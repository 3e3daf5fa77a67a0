"""Rolls a LeRobot policy out on the test splits, on several cores."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from kitchen_prefs.evaluation.episode_files import read_episodes, read_header
from kitchen_prefs.evaluation.isolation.policy_settings import policy_settings
from kitchen_prefs.evaluation.policy_loading import LoadedPolicy, load_policy
from kitchen_prefs.evaluation.policy_options import settings_of
from kitchen_prefs.evaluation.tiers import AnyEpisode, Tier, tier_of
from kitchen_prefs.utils.processes import run_module
from kitchen_prefs.utils.suggestions import suggest
from kitchen_prefs_leaderboard.submission_format import TRACKS


@dataclass(frozen=True)
class PolicyRun:
    """A policy that can be rolled out by several processes.

    Attributes:
        loaded_policy: The policy.
        options: The options of `kitchen-prefs evaluate` that load it.
        splits: What it is rolled out on.
    """

    loaded_policy: LoadedPolicy
    options: tuple[str, ...]
    splits: tuple[str, ...]

    def roll_out(self, folder: Path, salt: int, jobs: int) -> dict[str, list[AnyEpisode]]:
        """Roll out on the splits; episodes that are in the folder are reused.

        Args:
            folder: The folder of the episodes.
            salt: The session seed; 0 for the published sessions.
            jobs: How many processes share the splits.

        Returns:
            The episodes of each split, in the order of the sessions.

        Raises:
            ValueError: If the folder has episodes of another policy, or the checkpoint changes.
            OSError: If an evaluation fails; the message names its log.
        """
        folder.mkdir(parents=True, exist_ok=True)
        self._check_episodes(folder)

        def evaluate(splits: Sequence[str]) -> None:
            where = [f"--split={','.join(splits)}", f"--out={folder}", f"--salt={salt}"]
            arguments = ["evaluate", *self.options, *where]
            run_module("kitchen_prefs.cli", arguments, folder / f"{splits[0]}.log", "Rolling out")

        with ThreadPoolExecutor(jobs) as pool:
            list(pool.map(evaluate, shares(self.splits, jobs)))
        self._check_episodes(folder)
        return {
            split: sorted(read_episodes(folder / f"{split}.jsonl"), key=lambda one: one.session)
            for split in self.splits
        }

    def _check_episodes(self, folder: Path) -> None:
        advice = "delete that folder, or give another --out."
        for header in folder.glob("*.header.json"):
            if read_header(header, advice)["fingerprint"] != self.loaded_policy.fingerprint:
                raise ValueError(f"{folder} holds episodes of another policy; {advice}")


def shares(splits: Sequence[str], jobs: int) -> list[list[str]]:
    """Splits, distributed so that each process has about equally many sessions.

    A process for each split would load LeRobot as often, which takes longer than some splits.
    """
    shared: list[list[str]] = [[] for _ in range(min(jobs, len(splits)))]
    sessions = {split: tier_of(split).sessions(split) for split in splits}
    for split in sorted(splits, key=lambda split: -sessions[split]):
        min(shared, key=lambda of_process: sum(sessions[s] for s in of_process)).append(split)
    return shared


def load_policy_run(
    path: str | None,
    policy_type: str | None,
    settings: Sequence[str],
    track: str,
    tiers: Sequence[Tier],
) -> PolicyRun:
    """Load one's own policy for a track of the leaderboard.

    Args:
        path: A checkpoint, see `load_policy`.
        policy_type: The type of a policy that needs no training.
        settings: Settings of the policy to override, as in `--policy.rule=symbolic`.
        track: What the policy observes; on the open track, the track of its own settings.
        tiers: The tiers on whose test splits it is rolled out.

    Raises:
        ValueError: If there is no such track, or if it cannot be loaded for a tier, see
            `load_policy`, or is not one policy in all of them.
    """
    loaded = []
    for tier in tiers:
        arguments = settings_on_track(path, policy_type, settings, track, tier)
        loaded.append(load_policy(**arguments))
        tier.check(track=loaded[-1].track)
    if len({loaded_policy.fingerprint for loaded_policy in loaded}) > 1:
        raise ValueError("The policy has other settings in each tier; submit one tier at a time.")
    splits = tuple(split for tier in tiers for split in tier.test_splits)
    policy = f"--policy.path={path}" if path else f"--policy.type={policy_type}"
    return PolicyRun(loaded[0], (policy, *settings, f"--track={loaded[0].track}"), splits)


def settings_on_track(
    path: str | None, policy_type: str | None, settings: Sequence[str], track: str, tier: Tier
) -> dict[str, Any]:
    """The arguments of `load_policy` that load a policy for a track of the leaderboard.

    Args:
        path: A checkpoint.
        policy_type: The type of a policy that needs no training.
        settings: Settings of the policy to override, as in `--policy.rule=symbolic`.
        track: What the policy observes; on the open track, the track of its own settings.
        tier: The tier whose observations it has to fit.

    Raises:
        ValueError: If there is no such track or checkpoint, or an argument is no setting.
    """
    if track not in TRACKS:
        raise ValueError(f"There is no track {track!r}. {suggest(track, TRACKS)}")
    options = settings_of(settings)
    asked_for = None if track == "open" else track
    return policy_settings(path, policy_type, options, asked_for, tier.val)

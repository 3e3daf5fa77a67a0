"""Rolls a submission's policy out again, in processes that receive observations and nothing else.

The policy cannot tell which episodes count: published and fresh sessions, users and splits come in
one random order, mixed into batches, and each process is started without any of them.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from itertools import batched
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

import numpy as np
from tqdm import tqdm

from kitchen_prefs.evaluation.episode_files import EpisodeFile
from kitchen_prefs.evaluation.evaluator import Evaluator
from kitchen_prefs.evaluation.isolation.isolated_policy import IsolatedPolicy, Limits
from kitchen_prefs.evaluation.isolation.sandbox import has_sandbox
from kitchen_prefs.evaluation.rollouts import roll_out
from kitchen_prefs.evaluation.tiers import PREFERENCES, AnyEpisode, Tier
from kitchen_prefs_leaderboard.judgement import Reruns, compare, needs_more_runs
from kitchen_prefs_leaderboard.rerun_plan import Run, fresh_run
from kitchen_prefs_leaderboard.scoring import Entry
from kitchen_prefs_leaderboard.verification import Verification

Episodes = dict[str, list[AnyEpisode]]  # of each test split, in the order of the sessions
Batch = tuple["Run", str, tuple[int, ...]]  # a run, a split and some of its sessions
Files = dict[tuple["Run", str], EpisodeFile]  # the episodes of each run and split


@dataclass(frozen=True)
class Rerunner:
    """Rolls one policy out on the test splits of a tier, in several processes at once.

    Attributes:
        settings: The arguments of `load_policy`.
        folder: The folder of the episodes; those that it holds are reused. The policy does not see
            it, because it names the fresh sessions.
        jobs: How many processes.
        plugins: A folder of packages that these processes alone import from.
        limits: What each process may take.
        tier: The tier.
    """

    settings: dict[str, Any]
    folder: Path
    jobs: int
    plugins: Path | None = None
    limits: Limits | None = None
    tier: Tier = PREFERENCES

    def policy(self) -> IsolatedPolicy:
        """The policy in a new process.

        Raises:
            ValueError: If it is not loaded.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        log, hidden = self.folder / "policy.log", [self.folder]
        return IsolatedPolicy(
            self.settings, log, hidden=hidden, plugins=self.plugins, limits=self.limits
        )

    def roll_out(self, runs: Sequence[Run]) -> dict[str, Episodes]:
        """Roll the policy out.

        Args:
            runs: What to roll out.

        Returns:
            The episodes of each run, by its name.

        Raises:
            ValueError: If the policy ends, answers wrongly or takes too long, or if the folder
                holds episodes of another policy.
        """
        files = self._files(runs)
        batches = SimpleQueue[Batch]()
        for batch in _shuffled_batches(files):
            batches.put(batch)
        total = sum(len(run.sessions(split)) for run, split in files)
        there = sum(len(file.episodes) for file in files.values())
        bar = tqdm(total=total, initial=there, desc="Re-running", unit="episode")
        with bar, ThreadPoolExecutor(self.jobs) as pool:
            workers = min(self.jobs, batches.qsize())
            for worker in [pool.submit(self._work, batches, files, bar) for _ in range(workers)]:
                worker.result()
        return {run.name: _in_order(run, files) for run in runs}

    @cached_property
    def described(self) -> IsolatedPolicy:
        """The policy as it described itself; its process has ended."""
        with self.policy() as policy:
            return policy

    def _files(self, runs: Sequence[Run]) -> Files:
        return {
            (run, split): Evaluator(self.described, self.folder / run.name, run.salt).file(split)
            for run in runs
            for split in self.tier.test_splits
        }

    def _work(self, batches: "SimpleQueue[Batch]", files: Files, bar: tqdm) -> None:
        """Roll out batches in one process until there are no more."""
        with self.policy() as policy:
            while not batches.empty():
                with suppress(Empty):  # another worker may have taken the last one
                    run, split, sessions = batches.get_nowait()
                    episodes = roll_out(
                        policy,
                        split,
                        sessions=sessions,
                        salt=run.salt,
                        track=policy.track,
                        quiet=True,
                    )
                    for episode in episodes:
                        files[run, split].append(episode)
                    bar.update(len(episodes))


def rerun_submission(entry: Entry, rerunner: Rerunner, salt: int | None, by: str) -> Verification:
    """Roll a submission's policy out again and judge the submission.

    Args:
        entry: The submission, replayed.
        rerunner: Rolls its policy out.
        salt: The session seed of the fresh sessions; None draws one.
        by: Who re-runs.

    Raises:
        ValueError: If the policy fails, see `Rerunner.roll_out`.
    """
    fresh = fresh_run(rerunner.folder, entry.submission.track, salt)
    first, again = Run("published-1", 0), Run("published-2", 0)
    singly = Run("published-singly", 0, batch_size=1)
    # Fresh sessions, because a policy may know the published ones and behave there.
    alone = Run(f"alone-{fresh.salt}", fresh.salt, few=True, batch_size=1)
    found = rerunner.roll_out([first, alone, fresh])
    if needs_more_runs(entry, found[first.name]):
        found |= rerunner.roll_out([again, singly])
    reruns = Reruns(
        published=found[first.name],
        fresh=found[fresh.name],
        alone=found[alone.name],
        again=found.get(again.name),
        singly=found.get(singly.name),
    )
    return compare(entry, reruns, salt=fresh.salt, by=by, sandbox=has_sandbox())


def _shuffled_batches(files: Files) -> list[Batch]:
    """What is still to be rolled out, in an order that nobody can foresee."""
    generator = np.random.default_rng()
    batches: list[Batch] = []
    for (run, split), file in files.items():
        missing = sorted(set(run.sessions(split)) - {e.session for e in file.episodes})
        order = generator.permutation(missing).tolist()
        batches += [(run, split, batch) for batch in batched(order, run.batch_size)]
    return [batches[i] for i in generator.permutation(len(batches))]


def _in_order(run: Run, files: Files) -> Episodes:
    return {
        split: sorted(file.episodes, key=lambda episode: episode.session)
        for (of_run, split), file in files.items()
        if of_run == run
    }

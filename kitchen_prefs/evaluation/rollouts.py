"""Rolls a policy out on a split: every session once, a batch of environments in lockstep."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import batched
from typing import Protocol

import numpy as np
import torch
from tqdm import tqdm

from kitchen_prefs.envs.environment import DishwasherLoading
from kitchen_prefs.evaluation.episode_files import EpisodeFile
from kitchen_prefs.metrics import Episode
from kitchen_prefs.simulation.kitchen import decision_kind
from kitchen_prefs.splits import get_split

BATCH_SIZE = 16  # decisions of one forward pass; more gains little on a CPU


class Policy(Protocol):
    """What decides for B episodes at once; `policy_loading.LoadedPolicy` is one."""

    def reset(self) -> None:
        """Forget everything: a new batch of episodes begins."""

    def act(self, observations: Sequence[dict[str, np.ndarray]], tasks: list[str]) -> np.ndarray:
        """The actions for the observations and tasks of B environments, (B, 7)."""


def roll_out(
    decider: Policy,
    split: str,
    *,
    sessions: Iterable[int] | None = None,
    salt: int = 0,
    track: str = "standard",
    prompt_of: str = "same",
    prompts: int = 1,
    expert_states: bool = False,
    batch_size: int = BATCH_SIZE,
    file: EpisodeFile | None = None,
) -> list[Episode]:
    """Roll a policy out on sessions of a split.

    Args:
        decider: The policy.
        split: The split's name.
        sessions: Which sessions, all if not given.
        salt: The session seed; 0 is the published one.
        track: The track of the environment.
        prompt_of: "same", or "other" for a prompt of another preference.
        prompts: How many demonstrations prompt an episode.
        expert_states: Carry out the expert's decisions and note what the policy would have chosen,
            see `metrics.category_accuracy`.
        batch_size: How many sessions are rolled out at once. What a deterministic policy does in a
            session does not depend on it. A policy that samples draws for the whole batch at once:
            its episodes are the same only when all sessions are rolled out again with the same
            batch size, and without a kill in between.
        file: Where each episode is written as it ends; the sessions in it are not rolled out again.

    Returns:
        The episodes, one a session, in the sessions' order.

    Raises:
        ValueError: If the split, a session, the track or `prompt_of` does not exist, or if there
            are not so many prompts.
    """
    wanted = list(range(get_split(split).sessions) if sessions is None else sessions)
    episodes = {e.session: e for e in file.episodes} if file else {}
    missing = [session for session in wanted if session not in episodes]
    environments = [
        DishwasherLoading(split, track, prompt_of, prompts)
        for _ in range(min(batch_size, len(missing)))
    ]
    name, done = file.path.stem if file else split, len(wanted) - len(missing)
    with (
        tqdm(
            total=len(wanted), initial=done, desc=name, unit="episode", disable=not missing
        ) as bar,
        torch.random.fork_rng(),
    ):
        for batch in batched(missing, batch_size):
            torch.manual_seed(batch[0])  # so that a policy that samples can be repeated, see above
            for episode in _roll_out_batch(
                decider, environments[: len(batch)], batch, salt, expert_states
            ):
                episodes[episode.session] = episode
                if file:
                    file.append(episode)
                bar.update()
    return [episodes[session] for session in wanted]


def _roll_out_batch(
    decider: Policy,
    environments: Sequence[DishwasherLoading],
    sessions: Sequence[int],
    salt: int,
    expert_states: bool,
) -> Iterator[Episode]:
    """Roll out one session in each environment, and give each episode as soon as it ends.

    The batch keeps its size to the end, as policies keep a memory for each of its rows; what they
    decide for an episode that has ended is dropped.
    """
    decider.reset()
    options = [{"session": session, "salt": salt} for session in sessions]
    pairs = zip(environments, options, strict=True)
    observations = [environment.reset(options=option)[0] for environment, option in pairs]
    tasks = [environment.task_description for environment in environments]
    chosen: list[list[int]] = [[] for _ in environments]
    running = list(range(len(environments)))
    while running:
        actions = decider.act(observations, tasks)  # (B, 7)
        for i in tuple(running):
            environment, action = environments[i], actions[i]
            if expert_states:
                chosen[i].append(environment.simulator.choose(action)[0])
                action = environment.simulator.expert_action()
            observations[i], _, terminated, truncated, _ = environment.step(action)
            if terminated or truncated:
                running.remove(i)
                yield (
                    _beside_expert(environment, chosen[i])
                    if expert_states
                    else environment.episode()
                )


def _beside_expert(environment: DishwasherLoading, chosen: list[int]) -> Episode:
    """The expert's episode, with what the policy would have chosen as its decisions."""
    episode = environment.episode()
    return replace(
        episode,
        decisions=tuple(chosen),
        kinds=tuple(decision_kind(instance, environment.session.dishes) for instance in chosen),
        expert_decisions=episode.decisions,
        expert_kinds=episode.kinds,
    )

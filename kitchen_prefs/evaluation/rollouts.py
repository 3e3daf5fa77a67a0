"""Rolls a policy out on a split: every session once, in batches of environments."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import batched
from typing import Any, Protocol

import numpy as np
import torch
from tqdm import tqdm

from kitchen_prefs.envs.given_prompt import GivenPrompt
from kitchen_prefs.evaluation.episode_files import EpisodeFile
from kitchen_prefs.evaluation.tiers import AnyEpisode, tier_of
from kitchen_prefs.simulation.kitchen import decision_kind

BATCH_SIZE = 16  # environments in one forward pass; more gains little on a CPU


class Policy(Protocol):
    """A policy that acts in B environments at once; `policy_loading.LoadedPolicy` is one."""

    def reset(self) -> None:
        """Clear the policy's state: a new batch of episodes begins."""

    def act(self, observations: Sequence[dict[str, np.ndarray]], tasks: list[str]) -> np.ndarray:
        """The actions for the observations and tasks of B environments, (B, 7)."""


def roll_out(
    policy: Policy,
    split: str,
    *,
    sessions: Iterable[int] | None = None,
    salt: int = 0,
    track: str = "standard",
    prompt_of: str = "same",
    prompts: int = 1,
    given: GivenPrompt | None = None,
    expert_states: bool = False,
    batch_size: int = BATCH_SIZE,
    file: EpisodeFile | None = None,
    quiet: bool = False,
) -> list[Any]:
    """Roll a policy out on sessions of a split.

    Args:
        policy: The policy.
        split: The split's name, of either tier.
        sessions: Which sessions, all if not given.
        salt: The session seed; 0 is the published one.
        track: The track of the environment.
        prompt_of: "same", or "other" for a prompt of another preference.
        prompts: How many demonstrations prompt an episode.
        given: A prompt instead of the benchmark's; then every user has its preference.
        expert_states: Carry out the expert's decisions and record what the policy would have
            chosen, see `metrics.category_accuracy`.
        batch_size: How many sessions are rolled out at once. The episodes of a deterministic
            policy do not depend on it. A policy that samples draws for the whole batch at once: its
            episodes are reproduced only if all sessions are rolled out with the same batch size,
            without an interruption.
        file: Where each episode is written as it ends; the sessions in it are not rolled out again.
        quiet: Show no progress bar.

    Returns:
        One episode of the split's tier per session, in the order of the sessions.

    Raises:
        ValueError: If the split, a session, the track or `prompt_of` does not exist, or if there
            are fewer prompts than asked for.
    """
    tier = tier_of(split)
    wanted = list(range(tier.sessions(split)) if sessions is None else sessions)
    episodes = {e.session: e for e in file.episodes} if file else {}
    missing = [session for session in wanted if session not in episodes]
    asked = {"track": track, "prompt_of": prompt_of, "prompts": prompts, "given": given}
    tier.check(**asked, expert_states=expert_states)
    environments = [tier.environment(split, **asked) for _ in range(min(batch_size, len(missing)))]
    name, done = file.path.stem if file else split, len(wanted) - len(missing)
    with (
        tqdm(
            total=len(wanted),
            initial=done,
            desc=name,
            unit="episode",
            disable=quiet or not missing,
        ) as bar,
        torch.random.fork_rng(),
    ):
        for batch in batched(missing, batch_size):
            torch.manual_seed(batch[0])  # makes a policy that samples reproducible, see above
            for episode in _roll_out_batch(
                policy, environments[: len(batch)], batch, salt, expert_states
            ):
                episodes[episode.session] = episode
                if file:
                    file.append(episode)
                bar.update()
    return [episodes[session] for session in wanted]


def _roll_out_batch(
    policy: Policy,
    environments: Sequence[Any],
    sessions: Sequence[int],
    salt: int,
    expert_states: bool,
) -> Iterator[AnyEpisode]:
    """Roll out one session in each environment and yield each episode as soon as it ends.

    The batch keeps its size to the end, because policies keep a state per environment; actions for
    an episode that has ended are ignored.
    """
    policy.reset()
    options = [{"session": session, "salt": salt} for session in sessions]
    pairs = zip(environments, options, strict=True)
    observations = [environment.reset(options=option)[0] for environment, option in pairs]
    tasks = [environment.task_description for environment in environments]
    chosen: list[list[int]] = [[] for _ in environments]
    running = list(range(len(environments)))
    while running:
        actions = policy.act(observations, tasks)  # (B, 7)
        for i in tuple(running):
            environment, action = environments[i], actions[i]
            if expert_states:
                chosen[i].append(environment.simulator.choose(action)[0])
                action = environment.simulator.expert_action()
            observations[i], _, terminated, truncated, _ = environment.step(action)
            if terminated or truncated:
                running.remove(i)
                yield (
                    _on_expert_states(environment, chosen[i])
                    if expert_states
                    else environment.episode()
                )


def _on_expert_states(environment: Any, chosen: list[int]) -> AnyEpisode:
    """The expert's episode, with what the policy would have chosen as its decisions."""
    episode = environment.episode()
    return replace(
        episode,
        decisions=tuple(chosen),
        kinds=tuple(decision_kind(instance, environment.session.dishes) for instance in chosen),
        expert_decisions=episode.decisions,
        expert_kinds=episode.kinds,
    )

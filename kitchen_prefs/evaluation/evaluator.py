"""Evaluates a policy on a split: its episodes on disk, its metrics and its failure modes."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

from kitchen_prefs.envs.given_prompt import GivenPrompt
from kitchen_prefs.evaluation.episode_files import EpisodeFile, EvaluationConditions
from kitchen_prefs.evaluation.isolation.isolated_policy import IsolatedPolicy
from kitchen_prefs.evaluation.policy_loading import LoadedPolicy
from kitchen_prefs.evaluation.rollouts import BATCH_SIZE, roll_out
from kitchen_prefs.evaluation.tiers import tier_of
from kitchen_prefs.metrics import (
    Interval,
    category_accuracy,
    count_failure_modes,
    prompt_use,
    summarise,
    wilson,
)
from kitchen_prefs.utils.files import write_json


@dataclass(frozen=True)
class Summary:
    """The metrics of a split's episodes.

    Attributes:
        split: The split's name.
        episodes: How many episodes there are.
        metrics: The mean and interval of each metric that has a value.
        wilson_success: The share of successes with its Wilson interval, as LeRobot has it.
        failure_modes: For each failure mode, in how many episodes it occurred and how often in all.
    """

    split: str
    episodes: int
    metrics: dict[str, Interval]
    wilson_success: Interval
    failure_modes: dict[str, tuple[int, int]]


@dataclass(frozen=True)
class Evaluator:
    """A policy and the folder of its episodes.

    An evaluation that was killed resumes: episodes that are in the folder are not rolled out again.

    Attributes:
        loaded_policy: The policy.
        folder: Holds <split>.jsonl, one line per episode, and <split>.json, the summary.
        salt: The session seed; 0 is the published one.
        prompts: How many demonstrations prompt an episode.
        given: A prompt instead of the benchmark's; then every user has its preference.
        batch_size: How many sessions are rolled out at once.
    """

    loaded_policy: LoadedPolicy | IsolatedPolicy
    folder: Path
    salt: int = 0
    prompts: int = 1
    given: GivenPrompt | None = None
    batch_size: int = BATCH_SIZE

    def evaluate(
        self, split: str, *, with_prompt_use: bool = False, with_category_accuracy: bool = False
    ) -> Summary:
        """Evaluate the policy on a split and write the summary.

        Args:
            split: The split's name.
            with_prompt_use: Roll out each session with another preference's prompt, too.
            with_category_accuracy: Evaluate the policy's choices on the expert's states, too.

        Raises:
            ValueError: If the folder holds episodes of another policy, track, session seed (salt),
                prompt, number of prompts or version.
        """
        tier = tier_of(split)
        episodes = self.episodes(split)
        metrics = self._comparable(tier.summarise(episodes))
        if with_prompt_use:
            metrics["Prompt use"] = prompt_use(episodes, self.episodes(split, prompt_of="other"))
        if with_category_accuracy:
            on_expert_states = self.episodes(split, expert_states=True)
            metrics["Category accuracy"] = summarise(on_expert_states, category_accuracy)
        summary = Summary(
            split,
            len(episodes),
            metrics,
            wilson(sum(map(tier.success, episodes)), len(episodes)),
            count_failure_modes(map(tier.failure_modes, episodes)),
        )
        conditions = self._conditions(split, "same", expert_states=False)
        write_json(
            self.folder / f"{split}.json", {**asdict(summary), "conditions": asdict(conditions)}
        )
        return summary

    def mean_of_splits(self, splits: Sequence[str]) -> dict[str, Interval]:
        """Each metric's mean over splits of one tier, each of which counts the same."""
        episodes = [self.episodes(split) for split in splits]
        return self._comparable(tier_of(splits[0]).mean_of_splits(episodes))

    def episodes(
        self, split: str, *, prompt_of: str = "same", expert_states: bool = False
    ) -> list[Any]:
        """The policy's episodes on a split; those not in the folder are rolled out first."""
        return roll_out(
            self.loaded_policy,
            split,
            salt=self.salt,
            track=self.loaded_policy.track,
            prompt_of=prompt_of,
            prompts=self.prompts,
            given=self.given,
            expert_states=expert_states,
            batch_size=self.batch_size,
            file=self.file(split, prompt_of=prompt_of, expert_states=expert_states),
        )

    def _comparable(self, metrics: dict[str, Interval]) -> dict[str, Interval]:
        """With other users than the split's, leave out what is rescaled by floor and ceiling."""
        left_out = {"Rescaled"} if self.given else set()
        return {name: value for name, value in metrics.items() if name not in left_out}

    @cached_property
    def _fingerprint(self) -> str:
        return self.loaded_policy.fingerprint

    def _conditions(self, split: str, prompt_of: str, expert_states: bool) -> EvaluationConditions:
        policy, tier = self.loaded_policy, tier_of(split)
        return EvaluationConditions(
            policy=policy.type,
            fingerprint=self._fingerprint,
            track=policy.track,
            prompt_of=prompt_of,
            prompts=tier.prompts(split, self.prompts),
            expert_states=expert_states,
            salt=self.salt,
            data_version=tier.data_version,
            package_version=version("lerobot_policy_kitchen_prefs"),
            given_prompt=self.given.digest if self.given else None,
        )

    def file(
        self, split: str, *, prompt_of: str = "same", expert_states: bool = False
    ) -> EpisodeFile:
        """The file of the policy's episodes on a split."""
        name = split + "-other-prompt" * (prompt_of == "other") + "-expert-states" * expert_states
        conditions = self._conditions(split, prompt_of, expert_states)
        return EpisodeFile(self.folder / f"{name}.jsonl", conditions)

"""The rules as a LeRobot policy."""

from collections.abc import Callable
from functools import partial
from typing import Any
from zlib import crc32

import numpy as np
import torch
from lerobot.policies import PreTrainedPolicy
from lerobot.utils.constants import OBS_STATE
from torch import Tensor

from kitchen_prefs import instances
from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PREFERENCE, OBS_PROMPT
from kitchen_prefs.preferences import SEEN, Preference
from kitchen_prefs.simulation.expert import choose
from kitchen_prefs.simulation.sessions import preference_with
from lerobot_policy_kitchen_prefs.rules.configuration_rules import PEOPLE_RULES, RulesConfig
from lerobot_policy_kitchen_prefs.rules.observed_view import Memory, ObservedView
from lerobot_policy_kitchen_prefs.rules.people_plans import PlanFollower
from lerobot_policy_kitchen_prefs.rules.people_prompts import what_is_shown
from lerobot_policy_kitchen_prefs.rules.posterior import (
    PosteriorInference,
    prompt_likelihood,
    uniform_prior,
)
from lerobot_policy_kitchen_prefs.rules.preference_inference import (
    nearest_training_preference,
    symbolic_preference,
)

Inference = Callable[[ObservedView], Preference]  # the preference to act by now
Chooser = Callable[[np.ndarray], int]  # the row to choose of a set, in one episode


class RulesPolicy(PreTrainedPolicy):
    """Chooses by a rule, without learning."""

    config_class = RulesConfig
    name = "rules"

    def __init__(self, config: RulesConfig, **_: Any) -> None:
        super().__init__(config)
        config.validate_features()
        self.config: RulesConfig = config
        self.reset()

    def reset(self) -> None:
        """Clear the state: a new batch of episodes begins."""
        self._choosers: list[Chooser] = []

    @torch.no_grad()
    def select_action(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """Choose an action in every environment of the batch.

        Args:
            batch: The observation; `observation.instances` is (B, N, D) or flat.
            **_: Further arguments of LeRobot.

        Returns:
            The chosen rows' poses, (B, 7).

        Raises:
            ValueError: If the rule is for observations of the other tier.
        """
        sets = [instances.unpad(padded) for padded in batch[OBS_INSTANCES].cpu().numpy()]
        if not self._choosers:  # an episode's first decision: read its prompt or label
            self.config.check_tier(sets[0].shape[1])
            self._choosers = choosers_of(self.config.rule, batch, len(sets))
        rows = [choose_row(rows) for choose_row, rows in zip(self._choosers, sets, strict=True)]
        poses = [rows_[row, instances.POSE] for rows_, row in zip(sets, rows, strict=True)]
        return torch.from_numpy(np.stack(poses))

    def predict_action_chunk(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """The action as a chunk of one, (B, 1, 7)."""
        return self.select_action(batch)[:, None]

    def get_optim_params(self) -> dict[str, Any]:
        """Nothing to optimise."""
        return {}

    def forward(self, batch: dict[str, Tensor], **_: Any) -> tuple[Tensor, dict[str, Any]]:
        """Rules are not trained.

        Raises:
            ValueError: Always.
        """
        raise ValueError("A rule is not trained; use it with --policy.type=rules --policy.rule=...")


class PreferenceFollower:
    """Chooses in one episode as the first tier's expert would.

    Args:
        inference: Says of which preference.
        memory: The state of closed racks; None ignores them.
    """

    def __init__(self, inference: Inference, memory: Memory | None) -> None:
        self._inference = inference
        self._memory = memory

    def __call__(self, rows: np.ndarray) -> int:
        """The row to choose.

        Args:
            rows: The instance set, (n, 13), unpadded.
        """
        view = ObservedView(rows, self._memory)
        return choose(view, self._inference(view))


def choosers_of(rule: str, batch: dict[str, Tensor], size: int) -> list[Chooser]:
    """What chooses in each of the batch's episodes, from their first observation."""
    if rule == "random":
        return [_random_row] * size
    if rule in PEOPLE_RULES:
        return _people(rule, batch)
    # Only the symbolic rule ignores closed racks: it acts on what is visible.
    return [
        PreferenceFollower(inference, None if rule == "symbolic" else Memory())
        for inference in INFERENCES[rule](batch, size)
    ]


def _people(rule: str, batch: dict[str, Tensor]) -> list[Chooser]:
    evenings = batch[OBS_STATE][:, -1].int().tolist()
    shown = [what_is_shown(*one) for one in zip(_prompts(batch), evenings, strict=True)]
    return [PlanFollower(partial(PEOPLE_RULES[rule], one)) for one in shown]


def _random_row(rows: np.ndarray) -> int:
    """Any choosable row, drawn from a generator seeded by the set: the same in every batch."""
    generator = np.random.default_rng(crc32(np.ascontiguousarray(rows).tobytes()))
    return int(generator.choice(np.flatnonzero(instances.choosable(rows))))


def _fixed(preference: Preference) -> Inference:
    return lambda view: preference


def _majority(batch: dict[str, Tensor], size: int) -> list[Inference]:
    """All seven are equally frequent in `train`; the first one is taken."""
    return [_fixed(SEEN[0])] * size


def _nearest(batch: dict[str, Tensor], size: int) -> list[Inference]:
    return [_fixed(nearest_training_preference(prompt)) for prompt in _prompts(batch)]


def _symbolic(batch: dict[str, Tensor], size: int) -> list[Inference]:
    return [_fixed(symbolic_preference(prompt)) for prompt in _prompts(batch)]


def _promptless(batch: dict[str, Tensor], size: int) -> list[Inference]:
    return [PosteriorInference(uniform_prior()) for _ in range(size)]


def _bayes(batch: dict[str, Tensor], size: int) -> list[Inference]:
    return [PosteriorInference(prompt_likelihood(prompt)) for prompt in _prompts(batch)]


def _expert(batch: dict[str, Tensor], size: int) -> list[Inference]:
    labels = batch[OBS_PREFERENCE].flatten().tolist()
    return [_fixed(preference_with(round(label))) for label in labels]


def _prompts(batch: dict[str, Tensor]) -> np.ndarray:
    return batch[OBS_PROMPT].cpu().numpy()  # (B, R, D + 1)


INFERENCES: dict[str, Callable[[dict[str, Tensor], int], list[Inference]]] = {
    "majority": _majority,
    "nearest": _nearest,
    "symbolic": _symbolic,
    "promptless": _promptless,
    "bayes": _bayes,
    "expert": _expert,
}

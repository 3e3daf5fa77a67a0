"""The rules as a LeRobot policy."""

from collections.abc import Callable
from typing import Any
from zlib import crc32

import numpy as np
import torch
from lerobot.policies import PreTrainedPolicy
from torch import Tensor

from kitchen_prefs import instances
from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PREFERENCE, OBS_PROMPT
from kitchen_prefs.preferences import SEEN, Preference
from kitchen_prefs.simulation.expert import choose
from kitchen_prefs.simulation.sessions import preference_with
from lerobot_policy_kitchen_prefs.rules.configuration_rules import RulesConfig
from lerobot_policy_kitchen_prefs.rules.observed_view import Memory, ObservedView
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
        self._inferences: list[Inference] = []
        self._memories: list[Memory] = []

    @torch.no_grad()
    def select_action(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """Choose an action in every environment of the batch.

        Args:
            batch: The observation; `observation.instances` is (B, N, 13) or flat.
            **_: Further arguments of LeRobot.

        Returns:
            The chosen rows' poses, (B, 7).
        """
        sets = [instances.unpad(padded) for padded in batch[OBS_INSTANCES].cpu().numpy()]
        if self.config.rule == "random":
            rows = [_random_row(rows) for rows in sets]
        else:
            self._begin(batch, len(sets))
            rows = [self._row(i, rows) for i, rows in enumerate(sets)]
        poses = [rows_[row, instances.POSE] for rows_, row in zip(sets, rows, strict=True)]
        return torch.from_numpy(np.stack(poses))

    def _begin(self, batch: dict[str, Tensor], size: int) -> None:
        """At an episode's first decision, read each environment's prompt or label."""
        if not self._inferences:
            self._inferences = INFERENCES[self.config.rule](batch, size)
            self._memories = [Memory() for _ in range(size)]

    def _row(self, i: int, rows: np.ndarray) -> int:
        # Only the symbolic rule ignores closed racks: it acts on what is visible.
        view = ObservedView(rows, None if self.config.rule == "symbolic" else self._memories[i])
        return choose(view, self._inferences[i](view))

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
    return batch[OBS_PROMPT].cpu().numpy()  # (B, R, 14)


INFERENCES: dict[str, Callable[[dict[str, Tensor], int], list[Inference]]] = {
    "majority": _majority,
    "nearest": _nearest,
    "symbolic": _symbolic,
    "promptless": _promptless,
    "bayes": _bayes,
    "expert": _expert,
}

"""TTP as a LeRobot policy: pairs and loss in training, one prompt an episode at evaluation."""

from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from lerobot.datasets import LeRobotDatasetMetadata
from lerobot.policies import PreTrainedPolicy
from lerobot.utils.constants import ACTION
from torch import Tensor, nn

from kitchen_prefs.environment_config import OBS_INSTANCES, OBS_PROMPT
from kitchen_prefs.instances import POSE

from .attention import Tokens
from .configuration_ttp import TTPConfig
from .demonstrations import Demonstrations
from .network import TTPNetwork
from .pairing import Pairs, make_pairs
from .prompts import tokens_of_prompts
from .relabelling import Relabelling
from .repeats import Repeats
from .sets import choosable, chosen_rows, is_place_decision, is_real


class TTPPolicy(PreTrainedPolicy):
    """Transformer Task Planner (paper, section 2): points at the instance to choose."""

    config_class = TTPConfig
    name = "ttp"

    def __init__(
        self, config: TTPConfig, dataset_meta: LeRobotDatasetMetadata | None = None, **_: Any
    ) -> None:
        """Make the network, and read the demonstrations if there is a data set to train on.

        Args:
            config: The configuration.
            dataset_meta: The metadata of the data set that is trained on. Without it the policy
                acts but does not train.
            **_: What else LeRobot offers to policies.

        Raises:
            ValueError: If the features or the data set's columns are not those of kitchen_prefs.
        """
        super().__init__(config)
        config.validate_features()
        self.config: TTPConfig = config
        self.network = TTPNetwork(config)
        self.demonstrations: Demonstrations | None = None
        if dataset_meta is not None:
            chosen_only = config.prompt_tokens == "chosen"
            self.demonstrations = Demonstrations.read(dataset_meta, chosen_only)
            self.relabelling = Relabelling(self.demonstrations)
        self.reset()

    def get_optim_params(self) -> list[nn.Parameter]:
        """All parameters, in one group."""
        return list(self.parameters())

    # Training --------------------------------------------------------------------------------

    def forward(self, batch: dict[str, Tensor]) -> tuple[Tensor, dict[str, float]]:
        """The cross-entropy between the scores of the rows and the expert's choices.

        Args:
            batch: LeRobot's batch of B frames: the sets, the actions and the episodes.

        Returns:
            The loss, and the share of pairs in which the highest score is the expert's choice.

        Raises:
            ValueError: If the policy was made without a data set, or an action is no row's pose.
        """
        pairs = self._pair(batch)
        preference = self._encode(pairs.prompts)
        is_place = is_place_decision(pairs.sets)  # (S,)
        losses, correct = [], []
        for kind in (~is_place, is_place):  # apart, because place sets are several times as long
            if kind.any():
                scores = self._score(pairs.sets[kind], preference, pairs.prompt_of[kind])  # (K, N)
                losses.append(F.cross_entropy(scores, pairs.targets[kind], reduction="none"))
                correct.append(scores.argmax(dim=1) == pairs.targets[kind])
        return torch.cat(losses).mean(), {"accuracy": torch.cat(correct).float().mean().item()}

    def _pair(self, batch: dict[str, Tensor]) -> Pairs:
        if self.demonstrations is None:
            raise ValueError(
                "TTP takes its prompts from the data set that it trains on; make it with "
                "dataset_meta=dataset.meta, as lerobot-train does."
            )
        # The draws depend on the batch alone, so that a resumed run repeats an unbroken one.
        generator = np.random.default_rng(batch["index"].cpu().numpy())
        pairs = make_pairs(
            sets=batch[OBS_INSTANCES],
            targets=chosen_rows(batch[OBS_INSTANCES], batch[ACTION]),
            episodes=batch["episode_index"].cpu().numpy(),
            demonstrations=self.demonstrations,
            rounds=self.config.rounds if self.training else 1,
            generator=generator,
        )
        if self.config.relabel and self.training:
            return self.relabelling(pairs, generator)
        return pairs

    # Acting ----------------------------------------------------------------------------------

    def reset(self) -> None:
        """Forget the prompt and the choices: other episodes begin."""
        self._preference: Tokens | None = None
        self._repeats = Repeats()

    @torch.no_grad()
    def select_action(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """Choose a row of each set.

        Args:
            batch: The observations of B environments. The prompts are read on the first call after
                `reset`, and encoded once.
            **_: What else LeRobot offers to policies.

        Returns:
            The poses of the chosen rows, (B, 7).

        Raises:
            ValueError: If the sets or, on the first call, the prompts are missing.
        """
        self.eval()
        sets = _observed(batch, OBS_INSTANCES)  # (B, N, 13)
        if self._preference is None:
            self._preference = self._encode(_observed(batch, OBS_PROMPT))
        environments = torch.arange(len(sets), device=sets.device)
        scores = self._score(sets, self._preference, environments)  # (B, M)
        poses = sets[:, : scores.shape[1], POSE]  # (B, M, 7)
        if self.config.avoid_repeats:
            return self._repeats.choose(sets, poses, scores)
        return poses[environments, scores.argmax(dim=1)]

    def predict_action_chunk(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """The action as a chunk of one, (B, 1, 7)."""
        return self.select_action(batch)[:, None]

    # Both ------------------------------------------------------------------------------------

    def _encode(self, prompts: Tensor) -> Tokens:
        """Encode demonstrations, (G, P, 14)."""
        return self.network.encode(*tokens_of_prompts(prompts, self.config.prompt_tokens))

    def _score(self, sets: Tensor, preference: Tokens, prompt_of: Tensor) -> Tensor:
        """Score the rows of sets, (B, N, 13), cut to the longest of them, (B, M)."""
        mask = is_real(sets)  # (B, N)
        longest = int(mask.sum(dim=1).max())  # padding stands at the end
        sets, mask = sets[:, :longest], mask[:, :longest]
        scores = self.network.decide(sets, mask, preference, prompt_of)
        return scores.masked_fill(~choosable(sets), -torch.inf)


def _observed(batch: dict[str, Tensor], key: str) -> Tensor:
    if key not in batch:
        raise ValueError(
            f"TTP needs {key!r}, which the environment does not show; roll it out in an "
            "environment of kitchen_prefs, which shows sets of instances and a prompt."
        )
    return batch[key]

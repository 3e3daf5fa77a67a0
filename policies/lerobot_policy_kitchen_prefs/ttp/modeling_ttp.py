"""TTP as a LeRobot policy: prompt-situation pairs in training, one prompt an episode at rollout."""

from pathlib import Path
from typing import Any

import numpy as np
import torch
from lerobot.datasets import LeRobotDatasetMetadata
from lerobot.policies import PreTrainedPolicy
from lerobot.utils.constants import ACTION
from torch import Tensor, nn

from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.envs.lerobot_env import OBS_PROMPT
from kitchen_prefs.instances import POSE, choosable

from ..common.categories import Categories
from ..common.decision_loss import decision_loss
from ..common.denoising import Denoiser
from ..common.failed_choices import FailedChoices, synthesise_failures
from ..common.instance_sets import chosen_rows
from ..common.lerobot_features import observed, observed_sets
from ..common.rack_poses import RackPoses
from ..common.relabelling import relabel
from ..common.weight_loading import misfit_in_a_sentence
from .compact_network import CompactNetwork
from .configuration_ttp import TTPConfig
from .context_history import ContextHistory, split_history
from .network import Situations, TTPNetwork
from .prompt_pairing import Pairs, make_pairs
from .prompt_tokens import split_prompts, tokens_of_prompts
from .transformer import Tokens


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
            dataset_meta: The metadata of the training data set. Without it the policy can act but
                not train.
            **_: Other arguments of LeRobot's.

        Raises:
            ValueError: If the features or the data set's columns are not those of kitchen_prefs.
        """
        super().__init__(config)
        config.validate_features()
        self.config: TTPConfig = config
        self.network = self._make_network()
        self.recognition = Denoiser() if config.recognise else None  # named so in checkpoints
        self.demonstrations: DemonstrationStore | None = None
        if dataset_meta is not None:
            self.demonstrations = self._read_demonstrations(dataset_meta)
            if config.relabel and not config.described:
                self.categories = Categories.from_demonstrations(self.demonstrations)
                self.rack_poses = RackPoses.from_demonstrations(
                    self.demonstrations, self.categories
                )
            if self.recognition:
                self.recognition.fit(self.demonstrations)
        self.reset()

    def _make_network(self) -> TTPNetwork:
        return (CompactNetwork if self.config.departs_from_paper else TTPNetwork)(self.config)

    def _read_demonstrations(self, dataset_meta: LeRobotDatasetMetadata) -> DemonstrationStore:
        return DemonstrationStore.read(dataset_meta, self.config.prompt_tokens == "chosen")

    @classmethod
    def from_pretrained(cls, pretrained_name_or_path: str | Path, **options: Any) -> "TTPPolicy":
        """Load a checkpoint, see LeRobot's `PreTrainedPolicy.from_pretrained`.

        Raises:
            RuntimeError: If its weights do not fit the settings.
        """
        with misfit_in_a_sentence(pretrained_name_or_path):
            return super().from_pretrained(pretrained_name_or_path, **options)

    def get_optim_params(self) -> list[nn.Parameter]:
        """All parameters, in one group."""
        return list(self.parameters())

    def _get_default_peft_targets(self) -> dict[str, Any]:
        """Where LeRobot puts adapters by default: the projections of all attention layers."""
        return {"target_modules": r".*attention\.(query|key_value|output)", "modules_to_save": []}

    # Training --------------------------------------------------------------------------------

    def forward(self, batch: dict[str, Tensor]) -> tuple[Tensor, dict[str, float]]:
        """The cross-entropy between the scores of the rows and the expert's choices.

        Args:
            batch: LeRobot's batch of B frames: the sets, the actions and the episodes.

        Returns:
            The loss, and the shares of pick and of place decisions in which the highest score is
            the expert's choice.

        Raises:
            ValueError: If the policy was made without a data set, or an action is no row's pose.
        """
        pairs, situations = self.pair(batch)
        preference = self._encode(pairs.prompts)

        def score(bucket: Tensor) -> Tensor:
            return self._score(situations.select(bucket), preference, pairs.prompt_of[bucket])

        return decision_loss(pairs.sets, pairs.targets, score)

    def pair(self, batch: dict[str, Tensor]) -> tuple[Pairs, Situations]:
        """Pair a batch with prompts; in training, augment the pairs.

        Args:
            batch: The batch of `forward`.

        Returns:
            The pairs, and their situations with failed choices and history.

        Raises:
            ValueError: As `forward` does.
        """
        demonstrations = self._training_demonstrations()
        # The draws depend on the batch alone, so that a resumed run repeats an unbroken one.
        generator = np.random.default_rng(batch["index"].cpu().numpy())
        sets, history = split_history(batch)  # (B, N, 13), (B, K, 13)
        pairs = make_pairs(
            sets=sets,
            targets=chosen_rows(sets, batch[ACTION]),
            episodes=batch["episode_index"].cpu().numpy(),
            demonstrations=demonstrations,
            rounds=self.config.rounds if self.training else 1,
            generator=generator,
        )
        failed = torch.zeros(pairs.sets.shape[:2], dtype=torch.bool, device=pairs.sets.device)
        if self.training and self.config.relabel:
            prompts, relabelled = relabel(
                *(pairs.prompts, pairs.sets, pairs.prompt_of),
                *(self.categories, self.rack_poses, generator),
            )
            pairs = pairs._replace(prompts=prompts, sets=relabelled)
        if self.training and self.config.failures:
            failed = synthesise_failures(pairs.sets, pairs.targets, generator)
        return pairs, Situations(pairs.sets, failed, history[pairs.sample])

    def _training_demonstrations(self) -> DemonstrationStore:
        """The demonstrations to draw prompts from.

        Raises:
            ValueError: If the policy was made without a data set.
        """
        if self.demonstrations is None:
            raise ValueError(
                "TTP draws its prompts from the training data set; make it with "
                "dataset_meta=dataset.meta, as lerobot-train does."
            )
        return self.demonstrations

    # Acting ----------------------------------------------------------------------------------

    def reset(self) -> None:
        """Forget prompt, failed choices and history: new episodes begin."""
        self._preference: Tokens | None = None
        self._failed_choices = FailedChoices()
        self._history = ContextHistory(self.config.context_history)

    @torch.no_grad()
    def select_action(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """Choose a row of each set.

        Args:
            batch: The observations of B environments. The prompts are read on the first call after
                `reset`, and encoded once. With several prompts for an episode, the mean of their
                log-probabilities decides.
            **_: Other arguments of LeRobot's.

        Returns:
            The poses of the chosen rows, (B, 7).

        Raises:
            ValueError: If the sets or, on the first call, the prompts are missing.
        """
        self.eval()
        raw_sets = observed_sets(batch)  # (B, N, 13)
        sets = self.recognition(raw_sets) if self.recognition else raw_sets
        if self._preference is None:
            self._preference = self._encode(split_prompts(observed(batch, OBS_PROMPT)))
        situations = Situations(sets, self._failed_choices.find(sets), self._history.update(sets))
        choices = self._log_probabilities(situations, self._preference).argmax(dim=1)  # (B,)
        environments = torch.arange(len(sets), device=sets.device)  # (B,)
        self._failed_choices.record(sets[environments, choices])
        return raw_sets[environments, choices][:, POSE]

    def predict_action_chunk(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """The action as a chunk of one, (B, 1, 7)."""
        return self.select_action(batch)[:, None]

    def _log_probabilities(self, situations: Situations, preference: Tokens) -> Tensor:
        """The log-probabilities of rows, the mean of V prompts for each of B situations, (B, M)."""
        prompt_of = torch.arange(len(preference.features), device=preference.features.device)
        situation_of = prompt_of // (len(prompt_of) // len(situations.sets))  # (B V,)
        scores = self._score(situations.select(situation_of), preference, prompt_of)  # (B V, M)
        log_probabilities = scores.log_softmax(dim=1)  # (B V, M)
        return log_probabilities.unflatten(0, (len(situations.sets), -1)).mean(dim=1)

    # Both ------------------------------------------------------------------------------------

    def _encode(self, prompts: Tensor) -> Tokens:
        """Encode demonstrations, (G, P, 14)."""
        return self.network.encode(*tokens_of_prompts(prompts, self.config.prompt_tokens))

    def _score(self, situations: Situations, preference: Tokens, prompt_of: Tensor) -> Tensor:
        """Score the rows of B sets, cut to the M rows of the longest of them, (B, M)."""
        situations = situations.trimmed()
        scores = self.network.decide(situations, preference, prompt_of)
        return scores.masked_fill(~choosable(situations.sets), -torch.inf)

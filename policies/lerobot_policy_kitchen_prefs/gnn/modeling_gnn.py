"""The graph network as a LeRobot policy: imitation in training, one row of each set at rollout.

Its input contains the preference's true label: the privileged track.
"""

from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from lerobot.datasets import LeRobotDatasetMetadata
from lerobot.policies import PreTrainedPolicy
from lerobot.utils.constants import ACTION
from torch import Tensor, nn

from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.envs.lerobot_env import OBS_PREFERENCE
from kitchen_prefs.instances import POSE, is_place_decision
from kitchen_prefs.preferences import TWELVE

from ..common.categories import Categories
from ..common.denoising import Denoiser
from ..common.failed_choices import FailedChoices, synthesise_failures
from ..common.instance_sets import accuracies, chosen_rows
from ..common.lerobot_features import observed, observed_sets
from ..common.weight_loading import misfit_in_a_sentence
from .configuration_gnn import GNNConfig
from .network import GNNetwork, RowScores


class GNNPolicy(PreTrainedPolicy):
    """Graph network with the preference as an input (paper, section 3.1, "Baselines")."""

    config_class = GNNConfig
    name = "gnn"

    def __init__(
        self, config: GNNConfig, dataset_meta: LeRobotDatasetMetadata | None = None, **_: Any
    ) -> None:
        """Make the network, and read the labels if there is a data set to train on.

        Args:
            config: The configuration.
            dataset_meta: The metadata of the training data set. Without it the policy can act but
                not learn by imitation.
            **_: Other arguments of LeRobot's.

        Raises:
            ValueError: If the features or the data set's columns are not those of kitchen_prefs, or
                if the data set has a preference that is none of the twelve.
        """
        super().__init__(config)
        config.validate_features()
        self.config: GNNConfig = config
        self.network = GNNetwork(config)
        self.recognition = Denoiser() if config.recognise else None  # named so in checkpoints
        self.labels: Tensor | None = None  # (E,), of each episode of the data set
        if dataset_meta is not None:
            demonstrations = DemonstrationStore.read(dataset_meta, chosen_only=True)
            self.labels = _labels_of(demonstrations, dataset_meta.repo_id)
            self.categories = Categories.from_demonstrations(demonstrations)
            if self.recognition:
                self.recognition.fit(demonstrations)
        self.reset()

    @classmethod
    def from_pretrained(cls, pretrained_name_or_path: str | Path, **options: Any) -> "GNNPolicy":
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
        """Where LeRobot puts adapters by default: all linear maps of nodes but the attention's.

        PEFT cannot adapt torch-geometric's own linear layer in the attention.
        """
        layers = r"inputs\.project|layers\.\d+\.(skip|feedforward\.[02])"
        targets = rf"network\.({layers}|readout\.(query|key|score))"
        return {"target_modules": targets, "modules_to_save": []}

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
        if self.labels is None:
            raise ValueError(
                "The graph network takes the preferences' labels from the training data set; make "
                "it with dataset_meta=dataset.meta, as lerobot-train does."
            )
        sets = observed_sets(batch)  # (B, N, 13)
        targets = chosen_rows(sets, batch[ACTION])  # (B,)
        labels = self.labels.to(sets.device)[batch["episode_index"]]  # (B,)
        failed = torch.zeros(sets.shape[:2], dtype=torch.bool, device=sets.device)
        if self.training and self.config.failures:
            # The draws depend on the batch alone, so that a resumed run repeats an unbroken one.
            generator = np.random.default_rng(batch["index"].cpu().numpy())
            failed = synthesise_failures(sets, targets, generator)
        scores = self.network(sets, failed, labels).scores  # (B, N)
        correct = scores.argmax(dim=1) == targets
        return F.cross_entropy(scores, targets), accuracies(correct, is_place_decision(sets))

    # Acting ----------------------------------------------------------------------------------

    def reset(self) -> None:
        """Forget failed choices: new episodes begin."""
        self._failed_choices = FailedChoices()

    @torch.no_grad()
    def select_action(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """Choose a row of each set.

        Args:
            batch: The observations of B environments of the privileged track.
            **_: Other arguments of LeRobot's.

        Returns:
            The poses of the chosen rows, (B, 7).

        Raises:
            ValueError: If the sets or the labels are missing.
        """
        self.eval()
        raw_sets, sets = observed_sets(batch), self._denoised(batch)  # (B, N, 13) each
        scores = self.score_rows(batch, self._failed_choices.find(sets)).scores  # (B, N)
        choices = sample(scores) if self.config.sample else scores.argmax(dim=1)  # (B,)
        environments = torch.arange(len(sets), device=sets.device)
        self._failed_choices.record(sets[environments, choices])
        return raw_sets[environments, choices][:, POSE]

    def predict_action_chunk(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """The action as a chunk of one, (B, 1, 7)."""
        return self.select_action(batch)[:, None]

    # Acting and reinforcement learning ---------------------------------------------------------

    @property
    def summary_size(self) -> int:
        """The size d of a set's summary."""
        return self.config.dim

    def score_rows(self, batch: dict[str, Tensor], failed: Tensor) -> RowScores:
        """Score the rows of observations.

        Args:
            batch: The batch of `select_action`.
            failed: Which rows have just failed, (B, N) bool.

        Returns:
            The rows' scores and the sets' summaries.

        Raises:
            ValueError: As `select_action` does.
        """
        labels = observed(batch, OBS_PREFERENCE).flatten().round().long()  # (B,)
        return self.network(self._denoised(batch), failed, labels)

    def _denoised(self, batch: dict[str, Tensor]) -> Tensor:
        """The observed sets, denoised where configured, (B, N, 13)."""
        sets = observed_sets(batch)
        return self.recognition(sets) if self.recognition else sets


def sample(scores: Tensor) -> Tensor:
    """Sample a row of each set by its probability, (B, N) -> (B,) int64."""
    return scores.softmax(dim=1).multinomial(1)[:, 0]


def _labels_of(demonstrations: DemonstrationStore, name: str) -> Tensor:
    """The preference's label of each episode, (E,) int64."""
    labels = torch.from_numpy(demonstrations.preference)
    if (labels >= len(TWELVE)).any():
        raise ValueError(
            f"The data set {name!r} has preferences that are none of the {len(TWELVE)} which the "
            "graph network has inputs for; train on dishwasher-train-v1 or dishwasher-train-all-v1."
        )
    return labels

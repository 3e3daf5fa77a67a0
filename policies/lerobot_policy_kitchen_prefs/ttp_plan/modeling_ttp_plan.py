"""TTP with a plan as a LeRobot policy: it learns to plan and to decide from the same batches."""

from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from lerobot.datasets import LeRobotDatasetMetadata
from lerobot.utils.constants import ACTION, OBS_STATE
from torch import Tensor

from kitchen_prefs.datasets.demonstration_store import DemonstrationStore
from kitchen_prefs.envs.lerobot_env import OBS_INSTANCES, OBS_PROMPT
from kitchen_prefs.instances import DECISION, POSE, as_rows, choosable
from kitchen_prefs.people.splits import PROMPTS_OF_TWO_USERS

from ..common.decision_loss import decision_loss
from ..common.failed_choices import FailedChoices, synthesise_failures
from ..common.instance_sets import chosen_rows
from ..common.lerobot_features import observed, observed_sets
from ..ttp.modeling_ttp import TTPPolicy
from ..ttp.prompt_tokens import split_prompts, tokens_of_prompts
from .augmentation import Augmentation
from .configuration_ttp_plan import PlanTTPConfig
from .dish_tokens import PlacedDishes, placed_dishes, read_placed
from .network import PlanNetwork, PlanSituations, Preferences
from .plan_reader import DESTINATIONS
from .rack_state import ContentsMemory


class PlanTTPPolicy(TTPPolicy):
    """Transformer Task Planner with a plan reader, for people's rules on attributes."""

    config_class = PlanTTPConfig
    name = "ttp_plan"
    network: PlanNetwork
    config: PlanTTPConfig

    def _read_demonstrations(self, dataset_meta: LeRobotDatasetMetadata) -> DemonstrationStore:
        whole = DemonstrationStore.read(dataset_meta, chosen_only=False)
        self._placed = read_placed(whole)
        return whole.chosen()

    def _make_network(self) -> PlanNetwork:
        return PlanNetwork(self.config)

    # Training --------------------------------------------------------------------------------

    def forward(self, batch: dict[str, Tensor]) -> tuple[Tensor, dict[str, float]]:
        """The loss of decisions and that of plans.

        Args:
            batch: LeRobot's batch of B frames: the sets, the actions and the episodes.

        Returns:
            The sum of the cross-entropies of the expert's choices, of the destinations of all
            dishes of the frames' episodes, and of which of two dishes of one rack is picked first;
            and the shares of each that are right.

        Raises:
            ValueError: If the policy was made without a data set, or an action is no row's pose.
        """
        generator = np.random.default_rng(batch["index"].cpu().numpy())
        episodes = batch["episode_index"].cpu().numpy()
        sets = as_rows(batch[OBS_INSTANCES])  # (B, N, 21)
        targets = chosen_rows(sets, batch[ACTION])  # (B,)
        others = self._others(episodes, generator)
        augmentation = Augmentation(
            len(sets), self.config, generator if self.training else None, sets.device
        )
        sets = augmentation.of_rows(sets)
        own = augmentation.of_dishes(self._placed_by(episodes, sets.device))
        contents = own.contents_at(sets[..., DECISION].amax(dim=1))  # (B, 4, 7)
        failed = torch.zeros(sets.shape[:2], dtype=torch.bool, device=sets.device)
        if self.training:
            failed = synthesise_failures(sets, targets, generator)
        situations = PlanSituations(sets, failed, contents)
        shown, asked = augmentation.split(own)
        preference = self._preference_of(others, shown, augmentation)
        decided = torch.arange(min(len(sets), self.config.decided), device=sets.device)
        situations, targets = situations.select(decided), targets[decided]

        def score(bucket: Tensor) -> Tensor:
            return self._score_rows(situations.select(bucket), preference, bucket)

        loss, facts = decision_loss(situations.sets, targets, score)
        plan_loss, plan_facts = self._loss_of_plans(asked, preference)
        return loss + plan_loss, facts | plan_facts

    def _others(self, episodes: np.ndarray, generator: np.random.Generator) -> np.ndarray:
        """Another episode of each episode's user, (B,) int."""
        store = self._training_demonstrations()
        drawn = np.array(
            [store.draw(store.preference[e], np.array([e]), generator) for e in episodes]
        )
        if (drawn == episodes).any():
            raise ValueError(
                f"Episode {episodes[drawn == episodes][0]} is the only one of its user, so none "
                "can prompt it; train on people_train, whose users have two each."
            )
        return drawn

    def _preference_of(
        self, episodes: np.ndarray, own: PlacedDishes, augmentation: Augmentation
    ) -> Preferences:
        """Read episodes, and dishes that are shown beside them."""
        device, store = own.mask.device, self._training_demonstrations()
        prompts = torch.from_numpy(store.prompts(list(episodes))).to(device)
        prompts = augmentation.of_rows(prompts)  # (B, P, 22)
        dishes = augmentation.of_dishes(self._placed_by(episodes, device))
        dishes = augmentation.of_prompts(dishes).with_others(own)
        return Preferences(
            self.network.reader.encode(dishes, augmentation.names),
            self.network.encode(*tokens_of_prompts(prompts, self.config.prompt_tokens)),
        )

    def _placed_by(self, episodes: np.ndarray, device: torch.device) -> PlacedDishes:
        """What episodes do with their dishes."""
        placed = self._placed.select(torch.from_numpy(episodes))
        return PlacedDishes(*(part.to(device) for part in placed))

    def _loss_of_plans(
        self, asked: PlacedDishes, preference: Preferences
    ) -> tuple[Tensor, dict[str, float]]:
        reader = self.network.reader
        everyone = torch.arange(len(asked.mask), device=asked.mask.device)
        plans = reader.plan(asked.attributes, preference.prompts, everyone)  # (B, n, d)
        names = preference.prompts.names
        scores = reader.destinations(plans, asked.attributes, asked.contents, names)[asked.mask]
        zones = asked.zones[asked.mask]
        turns = reader.turns(plans, asked.distances)  # (B, n)
        in_order = (turns[:, None] - turns[:, :, None])[asked.preferred()]
        of_order = F.softplus(-in_order).sum() / max(len(in_order), 1)
        loss = F.cross_entropy(scores, zones) + of_order
        return loss, {
            "zone_accuracy": (scores.argmax(dim=1) == zones).float().mean().item(),
            "order_accuracy": (in_order > 0).sum().item() / max(len(in_order), 1),
        }

    # Acting ----------------------------------------------------------------------------------

    def reset(self) -> None:
        """Forget prompts, racks and failed choices: new episodes begin."""
        self._preferences: Preferences | None = None
        self._racks = ContentsMemory()
        self._failed_choices = FailedChoices()

    @torch.no_grad()
    def select_action(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """Choose a row of each set.

        Args:
            batch: The observations of B environments. The prompts are read on the first call after
                `reset`.
            **_: Other arguments of LeRobot's.

        Returns:
            The poses of the chosen rows, (B, 7).

        Raises:
            ValueError: If the sets or, on the first call, the prompts are missing.
        """
        self.eval()
        sets = observed_sets(batch)  # (B, N, 21)
        if self._preferences is None:
            self._preferences = self._read(observed(batch, OBS_PROMPT), observed(batch, OBS_STATE))
        failed = self._failed_choices.find(sets)
        situations = PlanSituations(sets, failed, self._racks.update(sets))
        environments = torch.arange(len(sets), device=sets.device)  # (B,)
        choices = self._score_rows(situations, self._preferences, environments).argmax(dim=1)
        self._failed_choices.record(sets[environments, choices])
        return sets[environments, choices][:, POSE]

    def _read(self, prompts: Tensor, state: Tensor) -> Preferences:
        """Read the demonstrations of B users: all, or that of whose evening it is."""
        users, evening = len(prompts), state[:, -1].long()
        demonstrations = split_prompts(prompts).unflatten(0, (users, -1))  # (B, V, P, 22)
        if demonstrations.shape[1] == PROMPTS_OF_TWO_USERS:
            demonstrations = demonstrations[torch.arange(users), evening][:, None]
        count = demonstrations.shape[1]
        demonstrations = demonstrations.flatten(0, 1)  # (B V, P, 22)
        tokens = self.network.encode(*tokens_of_prompts(demonstrations, self.config.prompt_tokens))
        dishes = placed_dishes(demonstrations).joined(count)
        names = torch.arange(DESTINATIONS, device=evening.device).expand(users, -1)
        return Preferences(self.network.reader.encode(dishes, names), tokens.joined(count))

    def _score_rows(
        self, situations: PlanSituations, preference: Preferences, prompt_of: Tensor
    ) -> Tensor:
        """Score the rows of B sets, cut to the M rows of the longest of them, (B, M)."""
        situations = situations.trimmed()
        scores = self.network.score_rows(situations, preference, prompt_of)
        return scores.masked_fill(~choosable(situations.sets), -torch.inf)

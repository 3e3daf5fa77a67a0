"""Deep sets (Zaheer et al., 2017) that read a prompt: perceptrons of rows, pooled."""

from typing import Any

import torch
import torch.nn.functional as F
from lerobot.policies import PreTrainedPolicy
from torch import Tensor, nn

from kitchen_prefs import instances
from lerobot_policy_kitchen_prefs.common.collision_model import CollisionModel
from lerobot_policy_kitchen_prefs.common.failed_choices import FailedChoices
from lerobot_policy_kitchen_prefs.common.instance_sets import chosen_rows, select_rows
from lerobot_policy_kitchen_prefs.common.score_correction import correct_scores

from .configuration_deepsets import DeepSetsConfig

COLUMNS, EXTENTS = instances.COLUMNS, instances.EXTENTS
SCALE = [10.0] * 3 + [3.0] * 3 + [1.0] * 4 + [0.05] + [1.0] * 2  # brings the columns to about 1
SAME_SIZE = 0.02  # m; the extents of two categories differ by more


class DeepSetsPolicy(PreTrainedPolicy):
    """Scores the rows of a set; chooses the best that has not just failed."""

    config_class = DeepSetsConfig
    name = "deepsets"

    def __init__(self, config: DeepSetsConfig, **_: Any) -> None:
        super().__init__(config)
        d = config.hidden
        self.of_prompt, self.of_row = _perceptron(COLUMNS, d, d), _perceptron(COLUMNS + 2 * d, d, d)
        self.of_set, self.of_place = _perceptron(3 * d, d, 1), _perceptron(COLUMNS, d, 1)
        self.collisions = CollisionModel()
        self.reset()

    def get_optim_params(self) -> list[nn.Parameter]:
        """All parameters."""
        return list(self.parameters())

    def reset(self) -> None:
        """Forget failed choices: new episodes begin."""
        self._failed = FailedChoices()

    def forward(self, batch: dict[str, Tensor]) -> tuple[Tensor, dict[str, float]]:
        """The cross-entropy of the expert's B choices, and how often they score best."""
        sets, scores = self._score(batch)  # (B, N, 13), (B, N)
        targets = chosen_rows(sets, batch["action"])  # (B,)
        accuracy = (scores.argmax(dim=1) == targets).float().mean().item()
        return F.cross_entropy(scores, targets), {"accuracy": accuracy}

    @torch.no_grad()
    def select_action(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """The poses of the best rows, (B, 7)."""
        sets, scores = self._score(batch)  # (B, N, 13), (B, N)
        best = (scores - 1e4 * self._failed.find(sets)).argmax(dim=1)  # (B,)
        chosen = sets[torch.arange(len(sets), device=sets.device), best]  # (B, 13)
        self._failed.record(chosen)
        return chosen[:, instances.POSE]

    def predict_action_chunk(self, batch: dict[str, Tensor], **_: Any) -> Tensor:
        """The action as a chunk of one, (B, 1, 7)."""
        return self.select_action(batch)[:, None]

    def _score(self, batch: dict[str, Tensor]) -> tuple[Tensor, Tensor]:
        """Score picks by the prompt, places by what stands beside: (B, N, 13), (B, N)."""
        sets = batch["observation.instances"].reshape(len(batch["observation.prompt"]), -1, COLUMNS)
        places = self.of_place(sets * sets.new_tensor(SCALE))[..., 0]  # (B, N)
        places = correct_scores(places, sets, self.collisions(sets), None)  # (B, N)
        is_place = instances.is_place_decision(sets)[:, None]  # (B, 1)
        scores = places.where(is_place, self._score_picks(sets, batch["observation.prompt"]))
        return sets, scores.masked_fill(~instances.choosable(sets), -torch.inf)

    def _score_picks(self, sets: Tensor, prompts: Tensor) -> Tensor:
        """Score objects, (B, N); the prompt is pooled as a whole, and over rows of their size."""
        shown, mask = select_rows(prompts, prompts[..., instances.CHOSEN] > 0)  # (B, L, 14), (B, L)
        features = self.of_prompt(shown[..., :COLUMNS] * sets.new_tensor(SCALE))  # (B, L, d)
        apart = torch.cdist(sets[..., EXTENTS], shown[..., EXTENTS]) / SAME_SIZE  # (B, N, L)
        alike = (-apart.square()).exp() * mask[:, None]  # (B, N, L)
        of_size = alike @ features / (alike.sum(dim=-1, keepdim=True) + 0.1)  # (B, N, d)
        of_all = _mean(features, mask)[:, None].expand_as(of_size)  # (B, N, d)
        timeless = sets * sets.new_tensor([*SCALE[:10], 0.0, *SCALE[11:]])  # (B, N, 13)
        rows = self.of_row(torch.cat([timeless, of_size, of_all], dim=-1)).relu()  # (B, N, d)
        real = instances.is_real(sets)  # (B, N)
        pooled = [_mean(rows, real), (rows * real[..., None]).amax(dim=1)]  # (B, d) each
        around = torch.cat(pooled, dim=-1)[:, None].expand(-1, sets.shape[1], -1)  # (B, N, 2 d)
        return self.of_set(torch.cat([rows, around], dim=-1))[..., 0]


def _mean(rows: Tensor, mask: Tensor) -> Tensor:
    """The mean of the rows that the mask, (B, N), selects, (B, N, d) -> (B, d)."""
    return (rows * mask[..., None]).sum(dim=1) / mask.sum(dim=1, keepdim=True)


def _perceptron(inputs: int, hidden: int, outputs: int) -> nn.Sequential:
    first, second = nn.Linear(inputs, hidden), nn.Linear(hidden, hidden)
    return nn.Sequential(first, nn.ReLU(), second, nn.ReLU(), nn.Linear(hidden, outputs))

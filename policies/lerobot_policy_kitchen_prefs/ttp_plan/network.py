"""TTP's network with a plan: rows are scored by what the reader knows of their dishes.

Tensors have B situations of N rows, of which M are waiting dishes, G prompts and d dimensions.
"""

from typing import NamedTuple, Self

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from kitchen_prefs.instances import DECISION, IS_PLACE, is_place_decision

from ..common.collision_model import attended_rows
from ..common.dish_locations import ELSEWHERE, on_counter, zone_of
from ..common.instance_sets import gather_rows, is_dish, longest, selected_indices
from ..common.score_correction import correct_scores
from ..ttp.compact_network import CompactNetwork
from ..ttp.encoder_ablations import hide
from ..ttp.transformer import Tokens
from .configuration_ttp_plan import PlanTTPConfig
from .dish_tokens import attributes_of, distances_to_sink
from .plan_reader import DESTINATIONS, EncodedPrompts, PlanReader
from .rack_state import open_racks

# What a row is told of its dish: the log-probability of each destination, of the row itself or of
# the rack that is out, and how long after the first dish its turn comes.
TOLD = DESTINATIONS + 2
NEVER = 1e4  # later than every turn
IMPROBABLE = -8.0  # a log-probability; less than one in a thousand is as good as never


class PlanSituations(NamedTuple):
    """The inputs of B decisions.

    Attributes:
        sets: The instance sets, zero-padded, (B, N, 21).
        failed: Which rows have just failed, (B, N) bool.
        contents: How many dishes of each category stand in each zone, seen now or before,
            (B, 4, 7).
    """

    sets: Tensor
    failed: Tensor
    contents: Tensor

    def select(self, which: Tensor) -> Self:
        """Some of the situations, by index or mask."""
        return type(self)(*(part[which] for part in self))

    def trimmed(self) -> Self:
        """The same situations without the padding that the longest set does not need."""
        rows = longest(self.sets)
        return self._replace(sets=self.sets[:, :rows], failed=self.failed[:, :rows])


class Preferences(NamedTuple):
    """What is known of G users.

    Attributes:
        prompts: What the plan reader knows.
        tokens: The preference embeddings gamma.
    """

    prompts: EncodedPrompts
    tokens: Tokens


class PlanNetwork(CompactNetwork):
    """The compact network of TTP, which is told what the plan reader says of each row's dish.

    scores (B, N)
      ▲
    pointer of TTP + weights · what is told ◄──┐
      ▲                                        │
    f_td ◄─── gamma                            │
      ▲                                        │
    f_e of the situation + what is told ◄── plan reader ◄── waiting dishes, prompts
    """

    def __init__(self, config: PlanTTPConfig) -> None:
        """Make the network of a configuration."""
        super().__init__(config)
        self.reader = PlanReader(config)
        self.told = nn.Linear(TOLD, config.dim)
        self.weights = nn.Parameter(torch.tensor([1.0, 1.0]))  # of the destination and of the turn

    def score_rows(
        self, situations: PlanSituations, preference: Preferences, prompt_of: Tensor
    ) -> Tensor:
        """Score the rows of situations.

        Args:
            situations: B situations of N rows.
            preference: What is known of G users.
            prompt_of: The user of each situation, (B,) int.

        Returns:
            A score for every row, (B, N).
        """
        assert self.failures
        assert self.clashes
        assert self.pointer
        sets = situations.sets
        told = self.tell(situations, preference, prompt_of)  # (B, N, 7)
        rows = hide(F.pad(sets, (0, 0, 0, 1)), [DECISION])  # with an ACT token, (B, N + 1, 21)
        mask = F.pad(attended_rows(sets), (0, 1), value=True)  # (B, N + 1)
        tokens = self.f_e(rows, mask)  # (B, N + 1, d)
        features = self.failures.embed(tokens.features, F.pad(situations.failed, (0, 1)))
        features = features + F.pad(self.told(told), (0, 0, 0, 1))
        outputs = self.f_td(tokens.with_features(features), preference.tokens, prompt_of).features
        act, outputs = outputs[:, -1], outputs[:, :-1]  # (B, d), (B, N, d)
        scores = self.pointer(act, outputs) + told[..., -2:] @ (self.weights * SIGNS.to(told))
        penalties = self.failures.penalties(outputs, situations.failed)
        return correct_scores(scores, sets, self.clashes(rows[:, :-1]), penalties)

    def tell(
        self, situations: PlanSituations, preference: Preferences, prompt_of: Tensor
    ) -> Tensor:
        """What the plan reader says of each row's dish, (B, N, 7); zeros for other rows."""
        sets = situations.sets
        is_place = is_place_decision(sets)[:, None]  # (B, 1)
        dishes = (sets[..., IS_PLACE] > 0).where(is_place, is_dish(sets) & on_counter(sets))
        index, mask = selected_indices(_one_place(sets, dishes))  # (B, M) each
        if index.shape[1] == 0:  # no dish waits in any of the situations
            return sets.new_zeros(*sets.shape[:2], TOLD)
        waiting = gather_rows(sets, index)  # (B, M, 21)
        attributes = attributes_of(waiting)  # (B, M, 18)
        plans = self.reader.plan(attributes, preference.prompts, prompt_of)  # (B, M, d)
        contents = situations.contents[:, None].expand(-1, index.shape[1], -1, -1)
        names = preference.prompts.names[prompt_of]  # (B, 5)
        where = self.reader.destinations(plans, attributes, contents, names)  # (B, M, 5)
        where = where.clamp(min=IMPROBABLE)
        turn = self.reader.turns(plans, distances_to_sink(waiting))  # (B, M)
        first = turn.masked_fill(~mask, NEVER).amin(dim=1, keepdim=True)  # (B, 1)
        told = torch.cat([where, (turn - first)[..., None]], dim=-1) * mask[..., None]
        spread = told.new_zeros(*sets.shape[:2], DESTINATIONS + 1)  # (B, N, 6)
        spread = spread.scatter(1, index[..., None].expand_as(told), told)
        spread = spread.sum(dim=1, keepdim=True).where(is_place[..., None], spread)
        spread = spread * dishes[..., None]
        where, turn = spread.split((DESTINATIONS, 1), dim=-1)
        own = own_destination(sets, where) * dishes  # (B, N)
        return torch.cat([where, own[..., None], turn], dim=-1)


SIGNS = torch.tensor([1.0, -1.0])  # what probably belongs here is chosen, and the first in turn


def own_destination(sets: Tensor, where: Tensor) -> Tensor:
    """The log-probability that a row's dish goes to where the row is, or to the rack that is out.

    Args:
        sets: (B, N, 21).
        where: The log-probabilities of destinations, (B, N, 5).

    Returns:
        For a place that of its zone, for a waiting dish that of the rack that is out, 0 where none
        is, (B, N).
    """
    of_place = where.gather(-1, zone_of(sets)[..., None])[..., 0]  # (B, N)
    racks = where[..., :ELSEWHERE].unflatten(-1, (2, 2)).logsumexp(dim=-1)  # (B, N, 2): top, bottom
    out = open_racks(sets)  # (B, 2) bool
    of_dish = (racks * out[:, None]).sum(dim=-1)  # (B, N)
    return of_place.where(sets[..., IS_PLACE] > 0, of_dish)


def _one_place(sets: Tensor, dishes: Tensor) -> Tensor:
    """The waiting dishes, or one of the places for the dish in hand, (B, N) bool."""
    first = dishes & (dishes.cumsum(dim=1) == 1)  # (B, N)
    return first.where(is_place_decision(sets)[:, None], dishes)

"""Choices that were made in vain: remembered when acting, invented in training.

A decision that cannot be carried out changes nothing. A deterministic policy that sees the same set
again would choose the same row for ever, so the network is shown which rows it has just chosen in
vain. Demonstrations have no such rows, as experts do not err. Training invents them: whatever the
expert did not choose may have been tried before.
"""

import numpy as np
import torch
from torch import Tensor, nn

from kitchen_prefs.envs.actions import METRES_PER_RADIAN
from kitchen_prefs.instances import IS_PLACE, POSITION, QUATERNION

from .categories import Categories
from .instance_sets import choosable

# The nearest row to the last choice is the same instance if it is this near: perception errs by a
# centimetre each time. Dishes in a rack can be nearer than that, but then they are not the nearest.
SAME = 0.05  # m, a turn counting as it does in the environment
# Every other situation follows on failures; then every row has failed with this probability, five
# of the fifty places for a dish.
SHARE_OF_SITUATIONS, SHARE_OF_ROWS = 0.5, 0.1


class FailedChoices:
    """What was chosen in vain since the last success, in each of B episodes."""

    def __init__(self) -> None:
        """Begin with none."""
        self._choices: list[Tensor] = []  # (B, 13) each
        self._in_vain: list[Tensor] = []  # (B,) each

    def find(self, sets: Tensor) -> Tensor:
        """Mark the rows that have failed.

        Args:
            sets: What is seen now, (B, N, 13). If what was chosen last can still be chosen, that
                choice was in vain; if not, it succeeded, and all earlier failures are forgotten.

        Returns:
            The marks, (B, N) bool.
        """
        failed = torch.zeros(sets.shape[:2], dtype=torch.bool, device=sets.device)
        if not self._choices:
            return failed
        last_failed = self._same(sets, self._choices[-1]).any(dim=1)  # (B,)
        self._in_vain = [in_vain & last_failed for in_vain in self._in_vain]
        for choice, in_vain in zip(self._choices, self._in_vain, strict=True):
            failed |= self._same(sets, choice) & in_vain[:, None]
        return failed

    def remember(self, choices: Tensor) -> None:
        """Remember the chosen rows, (B, 13)."""
        self._choices.append(choices)
        self._in_vain.append(torch.ones(len(choices), dtype=torch.bool, device=choices.device))
        while not self._in_vain[0].any():  # the last is always among them
            del self._choices[0], self._in_vain[0]

    @staticmethod
    def _same(sets: Tensor, choices: Tensor) -> Tensor:
        """Mark the choosable row nearest to each choice, if it is the same instance, (B, N)."""
        metres = (sets[..., POSITION] - choices[:, None, POSITION]).norm(dim=-1)  # (B, N)
        cosine = (sets[..., QUATERNION] * choices[:, None, QUATERNION]).sum(dim=-1).abs()
        distance = metres + METRES_PER_RADIAN * 2 * cosine.clamp(max=1).arccos()
        same_kind = sets[..., IS_PLACE] == choices[:, None, IS_PLACE]
        distance = distance.masked_fill(~(same_kind & choosable(sets)), torch.inf)
        nearest = torch.zeros_like(same_kind).scatter_(1, distance.argmin(1, keepdim=True), 1)
        return nearest & (distance < SAME)


def synthesise_failures(
    sets: Tensor, targets: Tensor, categories: Categories, generator: np.random.Generator
) -> Tensor:
    """Invent which rows have failed before the expert chose.

    Where the expert chose a place, a rack or the door, that choice has not failed before. A dish
    may have slipped from the hand.

    Args:
        sets: Sets, seen exactly, (B, N, 13).
        targets: The rows that the expert chose, (B,) int64.
        categories: The categories of dishes.
        generator: Source of randomness.

    Returns:
        Marks of the rows, (B, N) bool.
    """
    chance = generator.random(sets.shape[:2], dtype=np.float32) < SHARE_OF_ROWS
    chance &= generator.random((len(sets), 1), dtype=np.float32) < SHARE_OF_SITUATIONS
    situations = torch.arange(len(sets), device=sets.device)
    target = sets[situations, targets]  # (B, 13)
    graspable = categories.find(target)[1] & (target[:, IS_PLACE] == 0)  # (B,)
    may_fail = choosable(sets)
    may_fail[situations, targets] = graspable
    return torch.from_numpy(chance).to(sets.device) & may_fail


class FailedRows(nn.Module):
    """What a network makes of rows that were just chosen in vain."""

    def __init__(self, dim: int) -> None:
        """Make the mark, which begins as none, and the gate."""
        super().__init__()
        self.marker = nn.Parameter(torch.zeros(dim))
        self.gate = nn.Linear(dim, 1)

    def mark(self, features: Tensor, failed: Tensor) -> Tensor:
        """Mark rows' features, (..., d), those of (...) bool, so that all others know, too."""
        return features + failed[..., None] * self.marker

    def shares(self, outputs: Tensor, failed: Tensor) -> Tensor:
        """How far each row's score falls, by the network's outputs, (..., d) -> (...)."""
        return failed * self.gate(outputs)[..., 0].sigmoid()


def lowered(scores: Tensor, shares: Tensor, sets: Tensor) -> Tensor:
    """Let scores fall towards the lowest of their set.

    What is subtracted does not outdo the certainty with which a row was chosen wrongly, or how near
    to the corner a blocked place is; a fall to the bottom does.

    Args:
        scores: The scores, (B, N).
        shares: How far each falls, from 0, not at all, to 1, below all that may be chosen, (B, N).
        sets: What is scored, (B, N, 13).

    Returns:
        The scores, (B, N).
    """
    candidates = scores.detach().masked_fill(~choosable(sets), torch.inf)  # (B, N)
    lowest = candidates.amin(dim=1, keepdim=True) - 1  # (B, 1)
    return scores + shares * (lowest - scores)

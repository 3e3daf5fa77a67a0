"""Failed choices: tracked at rollout, synthesised in training.

A decision that cannot be carried out changes nothing. A deterministic policy that observes the same
set again would choose the same row again, for ever. So the network also takes as input which rows
have just failed. Demonstrations contain no failures, as experts make none; training synthesises
them: any row that the expert did not choose may have been tried before.
"""

import numpy as np
import torch
from torch import Tensor, nn

from kitchen_prefs.envs.actions import METRES_PER_RADIAN
from kitchen_prefs.instances import IS_PLACE, POSITION, QUATERNION, choosable

from .instance_sets import is_dish

# The nearest row to the last choice is the same instance if it is this near: perception errs by a
# centimetre each time. Dishes in a rack can be nearer than that, but then they are not the nearest.
SAME = 0.05  # m, a rotation counting as it does in the environment
# Every other situation follows on failures; then every row has failed with this probability, five
# of the fifty places for a dish.
SHARE_OF_SITUATIONS, SHARE_OF_ROWS = 0.5, 0.1


class FailedChoices:
    """Tracks the choices that have failed since the last success, in each of B episodes."""

    def __init__(self) -> None:
        """Begin with none."""
        self._choices: list[Tensor] = []  # (B, 13) each
        self._has_failed: list[Tensor] = []  # (B,) each

    def find(self, sets: Tensor) -> Tensor:
        """Find the rows that have failed.

        Args:
            sets: The sets observed now, (B, N, 13). A last choice that can still be chosen has
                failed; otherwise it succeeded, and all earlier failures are forgotten.

        Returns:
            A mask, (B, N) bool.
        """
        failed = torch.zeros(sets.shape[:2], dtype=torch.bool, device=sets.device)
        if not self._choices:
            return failed
        last_failed = self._same(sets, self._choices[-1]).any(dim=1)  # (B,)
        self._has_failed = [has_failed & last_failed for has_failed in self._has_failed]
        for choice, has_failed in zip(self._choices, self._has_failed, strict=True):
            failed |= self._same(sets, choice) & has_failed[:, None]
        return failed

    def record(self, choices: Tensor) -> None:
        """Record the rows that are chosen now, (B, 13)."""
        self._choices.append(choices)
        self._has_failed.append(torch.ones(len(choices), dtype=torch.bool, device=choices.device))
        while not self._has_failed[0].any():  # the last is always among them
            del self._choices[0], self._has_failed[0]

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


def synthesise_failures(sets: Tensor, targets: Tensor, generator: np.random.Generator) -> Tensor:
    """Draw which rows have failed before the expert chose.

    A place, a rack or the door that the expert chose has not failed before. A dish may have slipped
    from the gripper.

    Args:
        sets: Sets, (B, N, D).
        targets: The rows that the expert chose, (B,) int64.
        generator: Source of randomness.

    Returns:
        A mask, (B, N) bool.
    """
    drawn = generator.random(sets.shape[:2], dtype=np.float32) < SHARE_OF_ROWS
    drawn &= generator.random((len(sets), 1), dtype=np.float32) < SHARE_OF_SITUATIONS
    situations = torch.arange(len(sets), device=sets.device)
    target = sets[situations, targets]  # (B, 13)
    may_slip = is_dish(target)  # (B,)
    may_fail = choosable(sets)
    may_fail[situations, targets] = may_slip
    return torch.from_numpy(drawn).to(sets.device) & may_fail


class FailureEmbedding(nn.Module):
    """A network's weights for failed choices: an embedding of the input and a penalty."""

    def __init__(self, dim: int) -> None:
        """Make the embedding, which is zero at first, and the gate.

        Args:
            dim: The size of the network's tokens.
        """
        super().__init__()
        self.marker = nn.Parameter(torch.zeros(dim))
        self.gate = nn.Linear(dim, 1)

    def embed(self, features: Tensor, failed: Tensor) -> Tensor:
        """Add the embedding to rows' features, (..., d), where they have failed, (...) bool."""
        return features + failed[..., None] * self.marker

    def penalties(self, outputs: Tensor, failed: Tensor) -> Tensor:
        """How far the score of each row falls, from 0 to 1, by the network's outputs.

        Args:
            outputs: The network's outputs at the rows, (..., d).
            failed: Which rows have failed, (...) bool.

        Returns:
            The penalties, (...), for `correct_scores`.
        """
        return failed * self.gate(outputs)[..., 0].sigmoid()
